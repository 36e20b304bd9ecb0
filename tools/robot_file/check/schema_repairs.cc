// Findings and repairs of violations of the schema: R011, R016 to R019.

#include <fmt/format.h>

#include "tools/robot_file/check/draft_repair.h"
#include "tools/robot_file/check/places.h"
#include "tools/robot_file/check/repairs.h"

namespace koboshi::tools {
namespace {

using Kind = DraftChange::Kind;

std::string code_of(const XmlFault& fault) {
  switch (fault.kind) {
    case XmlFaultKind::kUnknownElement:
    case XmlFaultKind::kUnknownAttribute:
    case XmlFaultKind::kText:
      return "R017";
    case XmlFaultKind::kMissingElement:
    case XmlFaultKind::kMissingAttribute:
      return "R018";
    case XmlFaultKind::kSecondElement:
      return "R019";
    case XmlFaultKind::kValue:
      return fault.node.name() == "mass" ? "R011" : "R016";
    case XmlFaultKind::kAttributeValue:
      return "R016";
  }
  return {};
}

// Writes the right name for a misspelt element, or removes it.
void repair_unknown_element(const XmlFault& fault, Repair& repair) {
  const auto parent = fault.node.parent();
  const auto name = nearest_name(fault.node.name(), fault.names);
  if (name && parent && !parent->find(*name)) {
    repair.finding.repair = fmt::format("Write <{}>.", *name);
    repair.changes = {{Kind::kRename, fault.node, {}, *name}};
  } else {
    repair.finding.repair = "Remove it.";
    repair.changes = {{Kind::kErase, fault.node, {}, {}}};
  }
}

void repair_unknown_attribute(const XmlFault& fault, Repair& repair) {
  const auto name = nearest_name(fault.name, fault.names);
  repair.changes = {{Kind::kEraseAttribute, fault.node, fault.name, {}}};
  if (name && !fault.node.find_attribute(*name)) {
    repair.finding.repair = fmt::format("Write {}.", *name);
    repair.changes.push_back({Kind::kAttribute, fault.node, *name, fault.node.attribute(fault.name)});
  } else {
    repair.finding.repair = "Remove it.";
  }
}

std::string missing_text(const XmlNote& note, const std::string& name, const std::string& values) {
  std::string text = fmt::format("Add {}: {}", name, note.meaning);
  if (!values.empty()) text += ", " + values;
  if (!note.unit.empty() && note.unit != "1") text += " in " + note.unit;
  return text + ".";
}

// The table says what belongs there; only the user knows the value.
void describe_missing(const XmlFault& fault, Repair& repair) {
  for (const XmlRule& child : fault.rule->children)
    if (fault.kind == XmlFaultKind::kMissingElement && child.name == fault.name)
      repair.finding.repair =
          missing_text(child.note, "<" + child.name + ">",
                       describe_values(child.content, child.numbers, child.range, child.choices));
  for (const XmlAttributeRule& attribute : fault.rule->attributes)
    if (fault.kind == XmlFaultKind::kMissingAttribute && attribute.name == fault.name)
      repair.finding.repair =
          missing_text(attribute.note, attribute.name,
                       describe_values(attribute.content, 1, attribute.range, attribute.choices));
}

// A mass with a mistyped sign or comma; else that of the other side. Another mass nobody can guess.
void repair_mass(const XmlFault& fault, Repair& repair) {
  const std::string written = fault.node.text();
  const auto number = parse_numbers(written);
  if (!number || (number->size() == 1 && number->front() < 0.0)) {
    if (const auto value = nearest_value(written, XmlContent::kNumbers, 1, fault.rule->range, {})) {
      repair.finding.repair = fmt::format("Write {}.", *value);
      repair.changes = {{Kind::kText, fault.node, {}, *value}};
      return;
    }
  }
  repair.finding.repair = "Weigh the link, or take its mass from CAD.";
  const std::string other = other_side(repair.finding.element);
  const XmlNode link = *fault.node.parent()->parent();
  for (const XmlNode& node : link.parent()->children("link")) {
    if (node.find_attribute("name") != other) continue;
    const auto inertial = node.find("inertial");
    const auto mass = inertial ? inertial->find("mass") : std::nullopt;
    if (!mass || !is_valid_value(mass->text(), XmlContent::kNumbers, 1, fault.rule->range, {})) return;
    repair.finding.repair = fmt::format("{} has a mass of {}.", other, mass->text());
    repair.changes = {{Kind::kText, fault.node, {}, mass->text()}};
    return;
  }
}

void repair_value(const XmlFault& fault, Repair& repair) {
  const XmlRule& rule = *fault.rule;
  std::optional<std::string> value;
  if (const XmlAttributeRule* attribute = fault.attribute_rule) {
    value = nearest_value(fault.node.attribute(attribute->name), attribute->content, 1, attribute->range,
                          attribute->choices);
  } else {
    value = nearest_value(fault.node.text(), rule.content, rule.numbers, rule.range, rule.choices);
  }
  if (!value) return;
  const bool is_attribute = fault.attribute_rule != nullptr;
  repair.finding.repair = fmt::format("Write {}.", *value);
  repair.changes = {{is_attribute ? Kind::kAttribute : Kind::kText, fault.node, fault.name, *value}};
}

}  // namespace

Repair repair_of(const XmlFault& fault) {
  Repair repair;
  repair.finding = {.code = code_of(fault),
                    .severity = simulation::Severity::kError,
                    .found = fault.found,
                    .expected = fault.expected};
  set_place(repair.finding, place_of(fault.node));
  repair.finding.line = fault.line;
  if (fault.kind == XmlFaultKind::kUnknownAttribute || fault.kind == XmlFaultKind::kAttributeValue)
    repair.finding.key += "@" + fault.name;
  switch (fault.kind) {
    case XmlFaultKind::kUnknownElement:
      repair_unknown_element(fault, repair);
      break;
    case XmlFaultKind::kUnknownAttribute:
      repair_unknown_attribute(fault, repair);
      break;
    case XmlFaultKind::kMissingElement:
    case XmlFaultKind::kMissingAttribute:
      describe_missing(fault, repair);
      break;
    case XmlFaultKind::kSecondElement:
      repair.finding.repair = "Remove one of the two.";
      repair.changes = {{Kind::kErase, fault.node, {}, {}}};
      break;
    case XmlFaultKind::kValue:
    case XmlFaultKind::kAttributeValue:
      if (repair.finding.code == "R011") {
        repair_mass(fault, repair);
      } else {
        repair_value(fault, repair);
      }
      break;
    case XmlFaultKind::kText:
      repair.finding.repair = "Remove the text, or make it a comment.";
      repair.changes = {{Kind::kEraseTexts, fault.node, {}, {}}};
      break;
  }
  repair.finding.edits = edits_of(repair.changes);
  return repair;
}

}  // namespace koboshi::tools
