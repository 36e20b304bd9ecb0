#include "base/edit/xml_tree.h"

#include <tinyxml2.h>

#include <algorithm>
#include <memory>

#include "base/text/error.h"
#include "base/xml/xml_parse.h"

namespace koboshi {
namespace {

XmlPart to_part(const tinyxml2::XMLNode& node) {
  XmlPart part;
  part.line = node.GetLineNum();
  if (const tinyxml2::XMLElement* element = node.ToElement()) {
    part.name = element->Name();
    for (const auto* attribute = element->FirstAttribute(); attribute != nullptr;
         attribute = attribute->Next())
      part.attributes.push_back({attribute->Name(), attribute->Value()});
  } else if (node.ToDocument() == nullptr) {
    part.kind = node.ToText() != nullptr      ? XmlPart::Kind::kText
                : node.ToComment() != nullptr ? XmlPart::Kind::kComment
                                              : XmlPart::Kind::kOther;
    part.text = node.Value();
  }
  for (const auto* child = node.FirstChild(); child != nullptr; child = child->NextSibling())
    part.parts.push_back(to_part(*child));
  return part;
}

}  // namespace

const std::string* XmlPart::attribute(std::string_view attribute_name) const {
  const auto found = std::ranges::find(attributes, attribute_name, &XmlAttribute::name);
  return found == attributes.end() ? nullptr : &found->value;
}

std::vector<const XmlPart*> XmlPart::elements() const {
  std::vector<const XmlPart*> all;
  for (const XmlPart& part : parts)
    if (part.is_element()) all.push_back(&part);
  return all;
}

std::size_t XmlPart::element_count() const {
  return static_cast<std::size_t>(std::ranges::count_if(parts, &XmlPart::is_element));
}

std::size_t XmlPart::part_index(std::size_t element) const {
  std::size_t index = 0;
  for (std::size_t seen = 0; index < parts.size(); ++index)
    if (parts[index].is_element() && seen++ == element) break;
  return index;
}

std::string XmlPart::content() const {
  std::string content;
  for (const XmlPart& part : parts)
    if (part.kind == Kind::kText) content += part.text;
  return content;
}

bool same_parts(const XmlPart& a, const XmlPart& b) {
  return a.kind == b.kind && a.name == b.name && a.text == b.text && a.attributes == b.attributes &&
         std::ranges::equal(a.parts, b.parts, same_parts);
}

XmlPart parse_xml(std::string_view text, const std::filesystem::path& source) {
  tinyxml2::XMLDocument document;
  parse_xml_text(document, text, source);
  XmlPart whole = to_part(document);
  if (whole.element_count() != 1)
    throw InputError(source, 1, std::to_string(whole.element_count()) + " root elements", "one");
  return whole;
}

}  // namespace koboshi
