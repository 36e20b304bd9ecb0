#include "base/xml/xml_parse.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cctype>
#include <string>

#include "base/text/error.h"
#include "base/text/text.h"

namespace koboshi {
namespace {

// The deepest nesting of elements. It is less than tinyxml2's own limit, which differs between its versions
// and protects its recursion, so that a file is read or refused everywhere alike.
constexpr int kMaxLevels = 90;
static_assert(kMaxLevels < TINYXML2_MAX_ELEMENT_DEPTH - 2);

// Finds the first element that is nested too deep; null if there is none.
class DeepElement final : public tinyxml2::XMLVisitor {
 public:
  bool VisitEnter(const tinyxml2::XMLElement& element, const tinyxml2::XMLAttribute*) override {
    if (++levels_ > kMaxLevels && found_ == nullptr) found_ = &element;
    return found_ == nullptr;
  }
  bool VisitExit(const tinyxml2::XMLElement&) override {
    --levels_;
    return found_ == nullptr;
  }
  const tinyxml2::XMLElement* found() const { return found_; }

 private:
  int levels_ = 0;
  const tinyxml2::XMLElement* found_ = nullptr;
};

[[noreturn]] void refuse_depth(const std::filesystem::path& file, int line) {
  const std::string limit = std::to_string(kMaxLevels);
  throw InputError(file, line, "elements nested deeper than " + limit + " levels",
                   "at most " + limit + " levels");
}

// Returns "XML error: mismatched element" for tinyxml2's XML_ERROR_MISMATCHED_ELEMENT.
std::string describe_error(const tinyxml2::XMLDocument& document) {
  std::string name = document.ErrorName();
  for (const std::string_view prefix : {"XML_", "ERROR_"})
    if (name.starts_with(prefix)) name.erase(0, prefix.size());
  for (char& c : name) c = c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return "XML error: " + name;
}

}  // namespace

void parse_xml_text(tinyxml2::XMLDocument& document, std::string_view text,
                    const std::filesystem::path& file) {
  require_utf8(text, file);
  const tinyxml2::XMLError error = document.Parse(text.data(), text.size());
  const int line = std::max(document.ErrorLineNum(), 1);
  switch (error) {
    case tinyxml2::XML_SUCCESS: {
      DeepElement deep;
      document.Accept(&deep);
      if (deep.found() != nullptr) refuse_depth(file, deep.found()->GetLineNum());
      return;
    }
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      throw InputError(file, line, "an empty file", "an XML element");
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED:
      refuse_depth(file, line);
    default:
      throw InputError(file, line, describe_error(document), "well-formed XML");
  }
}

}  // namespace koboshi
