// The XML Schemas of a robot's file. SDF's children may be in any order and some of them repeat, for which
// XML Schema 1.0 has no content model: those elements are a repeated choice, and identity constraints on the
// element itself require what must be there and refuse a second one.

#include <algorithm>
#include <array>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "base/xml/xml_text.h"
#include "sim_board/description/schema/sdf_schema.h"
#include "tools/robot_file/reference/reference.h"
#include "tools/robot_file/reference/xsd_types.h"

namespace koboshi::tools {
namespace {

constexpr std::string_view kPrefix = "koboshi:";

bool is_prefixed(const XmlRule& rule) { return rule.name.starts_with(kPrefix); }

std::string local_name(const XmlRule& rule) {
  return is_prefixed(rule) ? rule.name.substr(kPrefix.size()) : rule.name;
}

std::string indent(int depth) { return std::string(2 * static_cast<std::size_t>(depth), ' '); }

// References between elements that the table does not hold: on the element `owner`, which has the prefix of
// its schema. A keyref also has `refer`.
struct XsdReference {
  std::string_view owner;
  std::string_view kind;
  std::string_view name;
  std::string_view selector;
  std::string_view field;
  std::string_view refer;
};

constexpr std::array kReferences{
    XsdReference{"model", "key", "frame_names", "link|joint|frame", "@name", ""},
    XsdReference{"model", "key", "body_names", "link|frame", "@name", ""},
    XsdReference{"model", "keyref", "parent_links", "joint/parent", ".", "body_names"},
    XsdReference{"model", "keyref", "child_links", "joint/child", ".", "body_names"},
    XsdReference{"model", "unique", "one_joint_a_link", "joint/child", ".", ""},
    XsdReference{"model", "unique", "node_ids", "joint/koboshi:drive", "@node_id", ""},
    XsdReference{"model", "unique", "servo_type_names", "koboshi:servo_type", "@name", ""},
    XsdReference{"model", "key", "library_files", "koboshi:servo_types", "@file", ""},
    XsdReference{"link", "key", "collision_names", "collision", "@name", ""},
    XsdReference{"link", "key", "visual_names", "visual", "@name", ""},
};

// The path from an element to a value that it must have, for an identity constraint; empty if there is none.
std::string required_value(const XmlRule& rule) {
  if (rule.content != XmlContent::kChildren) return rule.name;
  for (const XmlAttributeRule& attribute : rule.attributes)
    if (attribute.required) return rule.name + "/@" + attribute.name;
  for (const XmlRule& child : rule.children) {
    if (!child.is_always_required()) continue;
    if (const std::string path = required_value(child); !path.empty()) return rule.name + "/" + path;
  }
  return {};
}

// The path from an element to a value of a descendant, "axis/mimic".
std::string value_at(const XmlRule& rule, const std::string& descendant) {
  const std::size_t slash = descendant.find('/');
  for (const XmlRule& child : rule.children) {
    if (child.name != descendant.substr(0, slash)) continue;
    return slash == std::string::npos ? required_value(child)
                                      : child.name + "/" + value_at(child, descendant.substr(slash + 1));
  }
  return {};
}

class XsdWriter {
 public:
  explicit XsdWriter(std::string prefix) : types_(std::move(prefix)) {}

  // `count`: null for a global element.
  void element(const XmlRule& rule, const XmlCount* count, bool repeats, int depth) {
    std::string opening = fmt::format("{}<xs:element name=\"{}\"", indent(depth), local_name(rule));
    if (count != nullptr) opening += occurrences(*count, repeats);
    if (rule.content == XmlContent::kAnything) {
      text_ += opening + ">\n" + annotation(rule.note, {}, depth + 1) + indent(depth) + "</xs:element>\n";
      return;
    }
    const bool is_value = rule.content != XmlContent::kChildren;
    const std::string type =
        is_value ? types_.type_of(rule.content, rule.numbers, rule.range, rule.choices) : std::string();
    const std::string values = describe_values(rule.content, rule.numbers, rule.range, rule.choices);
    if (is_value && rule.attributes.empty()) {
      text_ += fmt::format("{} type=\"{}\">\n", opening, type) + annotation(rule.note, values, depth + 1);
    } else {
      text_ += opening + ">\n" + annotation(rule.note, values, depth + 1);
      complex_type(rule, type, depth + 1);
      constraints(rule, depth + 1);
    }
    text_ += indent(depth) + "</xs:element>\n";
  }

  const std::string& text() const { return text_; }
  std::string types() const { return types_.definitions(); }

 private:
  static std::string occurrences(XmlCount count, bool repeats) {
    return repeats || count == XmlCount::kRequired ? "" : " minOccurs=\"0\"";
  }

  static std::string annotation(const XmlNote& note, const std::string& values, int depth) {
    std::string text = note.meaning;
    if (!values.empty()) text += "; " + values;
    if (!note.unit.empty() && note.unit != "1") text += ", in " + note.unit;
    if (!note.fallback.empty()) text += "; default " + note.fallback;
    return fmt::format("{0}<xs:annotation><xs:documentation>{1} ({2}).</xs:documentation></xs:annotation>\n",
                       indent(depth), xml_escaped(text), xml_escaped(note.source));
  }

  void complex_type(const XmlRule& rule, const std::string& type, int depth) {
    text_ += indent(depth) + "<xs:complexType>\n";
    if (rule.content == XmlContent::kChildren) {
      if (!rule.children.empty()) children(rule, depth + 1);
      for (const XmlAttributeRule& one : rule.attributes) attribute(one, depth + 1);
    } else {
      text_ += fmt::format("{}<xs:simpleContent><xs:extension base=\"{}\">\n", indent(depth + 1), type);
      for (const XmlAttributeRule& one : rule.attributes) attribute(one, depth + 2);
      text_ += indent(depth + 1) + "</xs:extension></xs:simpleContent>\n";
    }
    text_ += indent(depth) + "</xs:complexType>\n";
  }

  static bool has_repeated(const XmlRule& rule) {
    return std::ranges::any_of(rule.children,
                               [](const XmlRule& child) { return child.count == XmlCount::kRepeated; });
  }

  void children(const XmlRule& rule, int depth) {
    const bool repeats = has_repeated(rule);
    text_ +=
        indent(depth) + (repeats ? "<xs:choice minOccurs=\"0\" maxOccurs=\"unbounded\">\n" : "<xs:all>\n");
    for (const XmlRule& child : rule.children) {
      if (is_prefixed(child)) {
        text_ += fmt::format("{}<xs:element ref=\"{}\"{}/>\n", indent(depth + 1), child.name,
                             occurrences(child.count, repeats));
      } else {
        element(child, &child.count, repeats, depth + 1);
      }
    }
    text_ += indent(depth) + (repeats ? "</xs:choice>\n" : "</xs:all>\n");
  }

  void attribute(const XmlAttributeRule& rule, int depth) {
    if (rule.name.starts_with("xmlns")) return;  // belongs to no schema
    std::string use;
    if (rule.required) use = " use=\"required\"";
    if (!rule.note.fallback.empty()) use = fmt::format(" default=\"{}\"", xml_escaped(rule.note.fallback));
    text_ += fmt::format("{}<xs:attribute name=\"{}\" type=\"{}\"{}>\n", indent(depth), rule.name,
                         types_.type_of(rule.content, 1, rule.range, rule.choices), use);
    text_ += annotation(rule.note, describe_values(rule.content, 1, rule.range, rule.choices), depth + 1);
    text_ += indent(depth) + "</xs:attribute>\n";
  }

  // The number of each child of an element with a repeated choice, and references.
  void constraints(const XmlRule& rule, int depth) {
    if (has_repeated(rule)) {
      for (const XmlRule& child : rule.children) {
        std::string path = required_value(child);
        if (child.count == XmlCount::kRepeated || path.empty()) continue;
        // Either the element or the one that it may be missing for, and not both.
        if (!child.unless.empty()) path += "|" + value_at(rule, child.unless);
        const bool required = child.count == XmlCount::kRequired;
        constraint(required ? "key" : "unique",
                   local_name(rule) + (required ? "_has_one_" : "_has_at_most_one_") + local_name(child), ".",
                   path, "", depth);
      }
    }
    for (const XsdReference& reference : kReferences)
      if (reference.owner == rule.name)
        constraint(reference.kind, reference.name, reference.selector, reference.field, reference.refer,
                   depth);
  }

  void constraint(std::string_view kind, std::string_view name, std::string_view selector,
                  std::string_view field, std::string_view refer, int depth) {
    text_ += fmt::format(
        "{0}<xs:{1} name=\"{2}\"{3}><xs:selector xpath=\"{4}\"/><xs:field xpath=\"{5}\"/></xs:{1}>\n",
        indent(depth), kind, name, refer.empty() ? "" : fmt::format(" refer=\"{}\"", refer), selector, field);
  }

  XsdTypes types_;
  std::string text_;
};

// Merges an element that has different content in two places: what each of them permits, nothing required.
XmlRule merged(const XmlRule& a, const XmlRule& b) {
  XmlRule both = a;
  for (const XmlAttributeRule& attribute : b.attributes)
    if (std::ranges::find(both.attributes, attribute.name, &XmlAttributeRule::name) == both.attributes.end())
      both.attributes.push_back(attribute);
  for (XmlAttributeRule& attribute : both.attributes) attribute.required = false;
  both.children.insert(both.children.end(), b.children.begin(), b.children.end());
  return both;
}

using RulesByName = std::map<std::string, XmlRule>;

// All elements with a prefix, which are global in their schema.
void take_prefixed(const XmlRule& rule, RulesByName& rules) {
  if (is_prefixed(rule)) rules.emplace(rule.name, rule);
  for (const XmlRule& child : rule.children) take_prefixed(child, rules);
}

}  // namespace

std::string robot_xsd_text() {
  XsdWriter writer("");
  writer.element(sim_board::sdf_rule(), nullptr, false, 1);
  return fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
<!-- Generated by `koboshi model reference write` from the table of the reader (sim_board/description/schema/sdf_schema.h). -->
<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema" xmlns:koboshi="{0}">
  <xs:import namespace="{0}" schemaLocation="robot-koboshi.xsd"/>
{1}
{2}</xs:schema>
)",
                     sim_board::kKoboshiNamespace, writer.text(), writer.types());
}

std::string koboshi_xsd_text() {
  RulesByName rules;
  take_prefixed(sim_board::sdf_rule(), rules);
  const XmlRule& library = sim_board::servo_library_rule();
  rules.insert_or_assign(library.name, merged(rules.at(library.name), library));
  XsdWriter writer(std::string{kPrefix});
  for (const auto& [name, rule] : rules) writer.element(rule, nullptr, false, 1);
  return fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
<!-- Generated by `koboshi model reference write` from the table of the reader (sim_board/description/schema/sdf_schema.h). -->
<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema" xmlns:koboshi="{0}" targetNamespace="{0}">
{1}
{2}</xs:schema>
)",
                     sim_board::kKoboshiNamespace, writer.text(), writer.types());
}

}  // namespace koboshi::tools
