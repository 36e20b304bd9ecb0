#include "base/edit/xml_document.h"

#include <algorithm>
#include <utility>

#include "base/file/output_file.h"
#include "base/text/error.h"
#include "base/text/text.h"

namespace koboshi {
namespace {

constexpr std::string_view kBlanksOfXml = " \t\r\n";

// Escapes a text between tags, or an attribute's value between these quotes.
std::string escaped(std::string_view value, char quote = '\0') {
  std::string text;
  for (const char c : value) {
    if (c == '&') {
      text += "&amp;";
    } else if (c == '<') {
      text += "&lt;";
    } else if (c == '>') {
      text += "&gt;";
    } else if (c == quote) {
      text += quote == '"' ? "&quot;" : "&apos;";
    } else {
      text += c;
    }
  }
  return text;
}

// Whether the scanner has found the elements and attributes of the parser.
bool agree(const XmlPart& part, const XmlPlace& place) {
  return part.name == place.name &&
         std::ranges::equal(part.attributes, place.attributes, {}, &XmlAttribute::name,
                            &XmlAttributePlace::name) &&
         std::ranges::equal(part.elements(), place.elements,
                            [](const XmlPart* child, const XmlPlace& at) { return agree(*child, at); });
}

const XmlPart& root_of(const XmlPart& whole) { return whole.parts[whole.part_index(0)]; }

// Begin of the line, if only blanks stand before this place in it.
std::optional<std::size_t> begin_of_line(std::string_view text, std::size_t at) {
  std::size_t begin = at;
  while (begin > 0 && (text[begin - 1] == ' ' || text[begin - 1] == '\t')) --begin;
  return begin == 0 || text[begin - 1] == '\n' ? std::optional(begin) : std::nullopt;
}

// The begin of the next line, if only blanks stand between this place and it.
std::optional<std::size_t> begin_of_next_line(std::string_view text, std::size_t at) {
  const std::size_t next = std::min(text.find_first_not_of(" \t\r", at), text.size());
  return next < text.size() && text[next] == '\n' ? std::optional(next + 1) : std::nullopt;
}

}  // namespace

XmlDocument::XmlDocument(std::filesystem::path file)
    : XmlDocument(file, read_text_file(file, "an XML file")) {}

XmlDocument::XmlDocument(std::filesystem::path source, std::string text) : source_(std::move(source)) {
  replace_text(std::move(text));
}

const XmlPart& XmlDocument::root() const { return root_of(whole_); }

const XmlPart* XmlDocument::find(const XmlPath& path) const {
  const XmlPart* part = &root();
  for (const std::size_t step : path) {
    if (step >= part->element_count()) return nullptr;
    part = &part->parts[part->part_index(step)];
  }
  return part;
}

const XmlPlace& XmlDocument::place(const XmlPath& path) const {
  const XmlPlace* place = &root_place_;
  for (const std::size_t step : path) {
    if (step >= place->elements.size())
      throw InputError(source_, 0, "element " + std::to_string(step) + " of <" + place->name + ">",
                       count_text(place->elements.size(), "element") + " in it");
    place = &place->elements[step];
  }
  return *place;
}

XmlPart& XmlDocument::element_of(XmlPart& whole, const XmlPath& path) const {
  static_cast<void>(place(path));  // throws
  XmlPart* part = &whole.parts[whole.part_index(0)];
  for (const std::size_t step : path) part = &part->parts[part->part_index(step)];
  return *part;
}

void XmlDocument::set_text(const XmlPath& path, std::string_view value, Blanks blanks) {
  XmlPart intended = whole_;
  XmlPart& element = element_of(intended, path);
  const XmlPlace& at = place(path);
  const bool is_empty = element.parts.empty();
  if (!is_empty && (element.parts.size() > 1 || element.parts[0].kind != XmlPart::Kind::kText))
    throw InputError(source_, element.line, "<" + element.name + "> with other parts than a text",
                     "a text alone");
  if (is_empty) {
    if (!value.empty())
      element.parts.push_back(
          {.kind = XmlPart::Kind::kText, .text = std::string(value), .line = element.line});
    if (at.is_short) {
      const std::size_t slash = text_.find('/', at.attributes_end);
      return apply({slash, at.end, ">" + escaped(value) + "</" + element.name + ">"}, intended);
    }
    return apply({at.content_begin, at.content_end, escaped(value)}, intended);
  }
  const auto replaced = [blanks](std::string_view text) {
    if (blanks == Blanks::kGo) return std::pair(std::size_t{0}, text.size());
    const std::size_t begin = std::min(text.find_first_not_of(kBlanksOfXml), text.size());
    const std::size_t end = std::max(text.find_last_not_of(kBlanksOfXml) + 1, begin);
    return std::pair(begin, end);
  };
  std::string& content = element.parts[0].text;
  const auto [first, last] = replaced(content);
  content.replace(first, last - first, value);
  if (content.find_first_not_of(kBlanksOfXml) == std::string::npos) element.parts.clear();
  const auto [begin, end] =
      replaced(std::string_view(text_).substr(at.content_begin, at.content_end - at.content_begin));
  apply({at.content_begin + begin, at.content_begin + end, escaped(value)}, intended);
}

void XmlDocument::set_attribute(const XmlPath& path, std::string_view name, std::string_view value) {
  XmlPart intended = whole_;
  XmlPart& element = element_of(intended, path);
  const XmlPlace& at = place(path);
  const auto found = std::ranges::find(at.attributes, name, &XmlAttributePlace::name);
  if (found == at.attributes.end()) {
    element.attributes.push_back({std::string(name), std::string(value)});
    std::string text = " " + std::string(name) + "=\"" + escaped(value, '"') + "\"";
    return apply({at.attributes_end, at.attributes_end, std::move(text)}, intended);
  }
  std::ranges::find(element.attributes, name, &XmlAttribute::name)->value = value;
  const char quote = text_[found->value_begin - 1];
  apply({found->value_begin, found->value_end, escaped(value, quote)}, intended);
}

void XmlDocument::erase_attribute(const XmlPath& path, std::string_view name) {
  XmlPart intended = whole_;
  XmlPart& element = element_of(intended, path);
  const XmlPlace& at = place(path);
  const auto found = std::ranges::find(at.attributes, name, &XmlAttributePlace::name);
  if (found == at.attributes.end())
    throw InputError(source_, element.line, "<" + element.name + "> without " + std::string(name),
                     "that attribute");
  std::erase_if(element.attributes, [&](const XmlAttribute& attribute) { return attribute.name == name; });
  const std::size_t begin = text_.find_last_not_of(kBlanksOfXml, found->begin - 1) + 1;
  apply({begin, found->end, {}}, intended);
}

void XmlDocument::insert_element(const XmlPath& parent, std::size_t index, std::string_view xml) {
  XmlPart added = parse_xml(xml, source_);
  if (added.parts.size() != 1)
    throw InputError(source_, 0, one_line(xml), "one element without comments around it");
  XmlPart intended = whole_;
  XmlPart& element = element_of(intended, parent);
  const XmlPlace& at = place(parent);
  if (index > at.elements.size())
    throw InputError(source_, element.line, "place " + std::to_string(index) + " in <" + at.name + ">",
                     "at most " + std::to_string(at.elements.size()));
  // Right behind the sibling before it, or else the first part.
  const std::size_t part = index == 0 ? 0 : element.part_index(index - 1) + 1;
  element.parts.insert(element.parts.begin() + static_cast<std::ptrdiff_t>(part),
                       std::move(added.parts.front()));
  apply(insertion(at, index, xml), intended);
}

XmlDocument::Change XmlDocument::insertion(const XmlPlace& parent, std::size_t index,
                                           std::string_view xml) const {
  if (parent.is_short) {
    const std::size_t slash = text_.find('/', parent.attributes_end);
    return {slash, parent.end, ">" + std::string(xml) + "</" + parent.name + ">"};
  }
  if (parent.elements.empty()) return {parent.content_begin, parent.content_begin, std::string(xml)};
  const XmlPlace& sibling = parent.elements[index == 0 ? 0 : index - 1];
  const std::size_t at = index == 0 ? parent.content_begin : sibling.end;
  const auto begin = begin_of_line(text_, sibling.begin);
  if (!begin) return {at, at, std::string(xml)};
  return {at, at, line_end() + text_.substr(*begin, sibling.begin - *begin) + std::string(xml)};
}

void XmlDocument::erase_element(const XmlPath& path) {
  XmlPart intended = whole_;
  if (path.empty()) throw InputError(source_, root().line, "the root element", "an element in it");
  const XmlPath parent(path.begin(), path.end() - 1);
  XmlPart& element = element_of(intended, parent);
  const XmlPlace at = place(path);
  element.parts.erase(element.parts.begin() + static_cast<std::ptrdiff_t>(element.part_index(path.back())));
  const auto begin = begin_of_line(text_, at.begin);
  const auto end = begin_of_next_line(text_, at.end);
  apply(begin && end ? Change{*begin, *end} : Change{at.begin, at.end}, intended);
}

void XmlDocument::apply(const Change& change, const XmlPart& intended) {
  std::string text = text_;
  text.replace(change.begin, change.end - change.begin, change.text);
  XmlPart parsed = parse_xml(text, source_);
  if (!same_parts(parsed, intended)) {
    const auto lines =
        std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(change.begin), '\n');
    throw InputError(source_, static_cast<int>(lines) + 1, "a layout in which this edit changes more",
                     "elements, attributes and texts");
  }
  take(std::move(text), std::move(parsed));
}

void XmlDocument::replace_text(std::string text) {
  XmlPart parsed = parse_xml(text, source_);
  take(std::move(text), std::move(parsed));
}

void XmlDocument::take(std::string text, XmlPart parsed) {
  XmlPlace place = locate_xml(text, source_);
  if (!agree(root_of(parsed), place))
    throw InputError(source_, 0, "a layout that cannot be edited", "elements, attributes and texts");
  text_ = std::move(text);
  whole_ = std::move(parsed);
  root_place_ = std::move(place);
}

std::string XmlDocument::line_end() const {
  const std::size_t first = text_.find('\n');
  return first != std::string::npos && first > 0 && text_[first - 1] == '\r' ? "\r\n" : "\n";
}

void XmlDocument::save() const { write_whole_file(source_, text_); }

}  // namespace koboshi
