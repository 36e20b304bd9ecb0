#include "tools/robot_file/reference/xsd_types.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/text/text.h"
#include "base/xml/xml_text.h"

namespace koboshi::tools {
namespace {

std::string range_name(const NumberRange& range) {
  std::string name;
  if (range.min > NumberRange().min) name += "_from_" + number_text(range.min);
  if (range.max < NumberRange().max) name += "_to_" + number_text(range.max);
  std::erase(name, '+');  // 1e+05: names may not contain it
  return name;
}

// The facets exclude NaN, and the largest finite numbers infinity.
std::string range_facets(const NumberRange& range) {
  return fmt::format("<xs:minInclusive value=\"{}\"/><xs:maxInclusive value=\"{}\"/>", number_text(range.min),
                     number_text(range.max));
}

std::string number_type(const NumberRange& range) {
  return fmt::format("<xs:restriction base=\"xs:double\">{}</xs:restriction>", range_facets(range));
}

std::string list_type(std::size_t numbers, const NumberRange& range) {
  return fmt::format(
      "<xs:restriction>\n      "
      "<xs:simpleType><xs:list><xs:simpleType>{}</xs:simpleType></xs:list></xs:simpleType>\n"
      "      <xs:length value=\"{}\"/>\n    </xs:restriction>",
      number_type(range), numbers);
}

std::string choice_type(XmlContent content, const std::vector<std::string>& choices) {
  std::string facets;
  for (const std::string& choice : choices)
    facets += fmt::format("<xs:enumeration value=\"{}\"/>", xml_escaped(choice));
  return fmt::format("<xs:restriction base=\"{}\">{}</xs:restriction>",
                     content == XmlContent::kInteger ? "xs:integer" : "xs:string", facets);
}

std::string choice_name(const std::vector<std::string>& choices) {
  std::string name = "one_of";
  for (const std::string& choice : choices) name += "_" + choice;
  std::ranges::replace(name, ':', '_');  // which separates a namespace
  return name;
}

}  // namespace

std::string XsdTypes::type_of(XmlContent content, std::size_t numbers, const NumberRange& range,
                              const std::vector<std::string>& choices) {
  std::string name;
  std::string definition;
  if (!choices.empty()) {
    name = choice_name(choices);
    definition = choice_type(content, choices);
  } else if (content == XmlContent::kText) {
    name = "text";
    definition = "<xs:restriction base=\"xs:string\"><xs:pattern value=\"\\S|\\S.*\\S\"/></xs:restriction>";
  } else if (content == XmlContent::kInteger) {
    name = "integer" + range_name(range);
    definition = fmt::format("<xs:restriction base=\"xs:integer\">{}</xs:restriction>", range_facets(range));
  } else if (numbers == 1) {
    name = "number" + range_name(range);
    definition = number_type(range);
  } else {
    name = fmt::format("numbers_{}", numbers) + range_name(range);
    definition = list_type(numbers, range);
  }
  definitions_.emplace(name, definition);
  return prefix_ + name;
}

std::string XsdTypes::definitions() const {
  std::string text;
  for (const auto& [name, definition] : definitions_)
    text += fmt::format("  <xs:simpleType name=\"{}\">\n    {}\n  </xs:simpleType>\n", name, definition);
  return text;
}

}  // namespace koboshi::tools
