#include "base/edit/xml_places.h"

#include <algorithm>

#include "base/text/error.h"

namespace koboshi {
namespace {

constexpr std::string_view kXmlBlanks = " \t\r\n";

class Scanner {
 public:
  Scanner(std::string_view text, const std::filesystem::path& source) : text_(text), source_(source) {}

  XmlPlace root() {
    while (true) {
      at_ = find("<", at_);
      if (!skip_markup()) return element();
    }
  }

 private:
  [[noreturn]] void fail(const std::string& expected) const {
    const std::size_t at = std::min(at_, text_.size());
    const auto lines = std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    throw InputError(source_, static_cast<int>(lines) + 1, "a layout that cannot be edited", expected);
  }

  std::size_t find(std::string_view what, std::size_t from) const {
    const std::size_t found = text_.find(what, from);
    if (found == std::string_view::npos) fail(std::string(what));
    return found;
  }

  bool starts_with(std::string_view what) const { return text_.substr(at_).starts_with(what); }

  // Skips a comment, a CDATA section or a processing instruction; returns whether there was one.
  bool skip_markup() {
    if (starts_with("<!--")) {
      at_ = find("-->", at_) + 3;
    } else if (starts_with("<![CDATA[")) {
      at_ = find("]]>", at_) + 3;
    } else if (starts_with("<?")) {
      at_ = find("?>", at_) + 2;
    } else if (starts_with("<!")) {
      fail("no document type declaration");
    } else {
      return false;
    }
    return true;
  }

  void skip_blanks() { at_ = std::min(text_.find_first_not_of(kXmlBlanks, at_), text_.size()); }

  std::string name() {
    const std::size_t begin = at_;
    at_ = std::min(text_.find_first_of(" \t\r\n=/>", at_), text_.size());
    if (at_ == begin) fail("a name");
    return std::string(text_.substr(begin, at_ - begin));
  }

  XmlAttributePlace attribute() {
    XmlAttributePlace place;
    place.begin = at_;
    place.name = name();
    skip_blanks();
    at_ = find("=", at_) + 1;
    skip_blanks();
    if (at_ >= text_.size() || (text_[at_] != '"' && text_[at_] != '\'')) fail("a value in quotes");
    place.value_begin = at_ + 1;
    place.value_end = find(text_.substr(at_, 1), place.value_begin);
    place.end = at_ = place.value_end + 1;
    return place;
  }

  XmlPlace element() {
    XmlPlace place;
    place.begin = at_++;
    place.name = name();
    place.attributes_end = at_;
    for (skip_blanks(); at_ < text_.size() && text_[at_] != '>' && text_[at_] != '/'; skip_blanks()) {
      place.attributes.push_back(attribute());
      place.attributes_end = at_;
    }
    place.is_short = starts_with("/>");
    at_ = find(">", at_) + 1;
    place.content_begin = place.content_end = place.end = at_;
    if (!place.is_short) content(place);
    return place;
  }

  void content(XmlPlace& place) {
    for (at_ = find("<", at_); !starts_with("</"); at_ = find("<", at_))
      if (!skip_markup()) place.elements.push_back(element());
    place.content_end = at_;
    place.end = at_ = find(">", at_) + 1;
  }

  std::string_view text_;
  const std::filesystem::path& source_;
  std::size_t at_ = 0;
};

}  // namespace

XmlPlace locate_xml(std::string_view text, const std::filesystem::path& source) {
  return Scanner(text, source).root();
}

}  // namespace koboshi
