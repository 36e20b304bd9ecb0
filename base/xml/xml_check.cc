#include "base/xml/xml_check.h"

#include <tinyxml2.h>

#include <algorithm>
#include <utility>

#include "base/text/units.h"

namespace koboshi {
namespace {

using tinyxml2::XMLAttribute;
using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

std::string tag(std::string_view name) { return "<" + one_line(name) + ">"; }

struct Value {
  std::string found;
  std::string expected;
};

// The values that the rule of an element or an attribute permits.
struct Permitted {
  explicit Permitted(const XmlRule& rule)
      : content(rule.content),
        numbers(rule.numbers),
        range(rule.range),
        choices(rule.choices),
        unit(rule.note.unit) {}
  explicit Permitted(const XmlAttributeRule& rule)
      : content(rule.content), numbers(1), range(rule.range), choices(rule.choices), unit(rule.note.unit) {}

  bool holds(const std::string& text) const { return is_valid_value(text, content, numbers, range, choices); }

  XmlContent content;
  std::size_t numbers;
  const NumberRange& range;
  const std::vector<std::string>& choices;
  const std::string& unit;
};

// Describes a value that is not permitted. A name is in quotes, so that white space at its end shows.
Value describe_value(const std::string& name, const std::string& text, const Permitted& permitted) {
  std::string expected =
      describe_values(permitted.content, permitted.numbers, permitted.range, permitted.choices);
  const std::string fault = name_fault(text);
  if (permitted.content == XmlContent::kText && !text.empty() && !fault.empty() &&
      (permitted.choices.empty() || permitted.holds(std::string(trimmed_name(text)))))
    return {name + " = \"" + one_line(text) + "\"", "a text without " + fault};
  const auto values = parse_numbers(text);
  if (permitted.content == XmlContent::kNumbers && values && values->size() == permitted.numbers) {
    const std::string question = unit_question(*values, permitted.unit, [&](double value) {
      return value >= permitted.range.min && value <= permitted.range.max;
    });
    if (!question.empty()) expected += " in " + permitted.unit + "; " + question;
  }
  return {name + " = " + one_line(text), std::move(expected)};
}

// Checks elements against their rules.
class Checker {
 public:
  Checker(const std::filesystem::path& file, std::vector<XmlFault>& faults) : file_(file), faults_(faults) {}

  void check(const XMLElement& element, const XmlRule& rule) const {
    if (rule.content == XmlContent::kAnything) return;
    check_attributes(element, rule);
    if (rule.content == XmlContent::kChildren) {
      check_children(element, rule);
    } else {
      check_content(element, rule);
    }
  }

 private:
  void add(XmlFaultKind kind, const XMLElement& element, const std::string& name, int line,
           const std::string& found, const std::string& expected, const XmlRule& rule,
           std::vector<std::string> names = {}, const XmlAttributeRule* attribute_rule = nullptr) const {
    faults_.push_back({kind, XmlNode(element, file_), name, line, found, expected, std::move(names), &rule,
                       attribute_rule});
  }

  void check_attributes(const XMLElement& element, const XmlRule& rule) const {
    for (const XMLAttribute* attribute = element.FirstAttribute(); attribute; attribute = attribute->Next()) {
      const auto known = std::find_if(rule.attributes.begin(), rule.attributes.end(),
                                      [&](const XmlAttributeRule& r) { return r.name == attribute->Name(); });
      if (known == rule.attributes.end()) {
        add(XmlFaultKind::kUnknownAttribute, element, attribute->Name(), attribute->GetLineNum(),
            "the unknown attribute " + one_line(attribute->Name()) + " of " + tag(rule.name),
            alternatives(rule.attributes, "no attribute"), rule, names_of(rule.attributes));
      } else if (const Permitted permitted(*known); !permitted.holds(attribute->Value())) {
        const Value value = describe_value(known->name, attribute->Value(), permitted);
        add(XmlFaultKind::kAttributeValue, element, known->name, attribute->GetLineNum(), value.found,
            value.expected, rule, {}, &*known);
      }
    }
    for (const XmlAttributeRule& r : rule.attributes) {
      if (r.required && !element.Attribute(r.name.c_str())) {
        add(XmlFaultKind::kMissingAttribute, element, r.name, element.GetLineNum(),
            tag(rule.name) + " without " + r.name, "that attribute", rule);
      }
    }
  }

  // Whether an element has one at "child" or "child/grandchild"; no path: no.
  static bool has_path(const XMLElement& element, const std::string& path) {
    if (path.empty()) return false;
    const std::size_t slash = path.find('/');
    const XMLElement* const child = element.FirstChildElement(path.substr(0, slash).c_str());
    if (child == nullptr || slash == std::string::npos) return child != nullptr;
    return has_path(*child, path.substr(slash + 1));
  }

  void check_children(const XMLElement& element, const XmlRule& rule) const {
    for (const XMLNode* node = element.FirstChild(); node; node = node->NextSibling()) {
      if (node->ToText()) {
        add(XmlFaultKind::kText, element, {}, node->GetLineNum(),
            "the text " + one_line(node->Value()) + " in " + tag(rule.name),
            alternatives(rule.children, "nothing"), rule);
      }
      if (const XMLElement* child = node->ToElement()) check_child(*child, element, rule);
    }
    for (const XmlRule& r : rule.children) {
      if (r.count == XmlCount::kRequired && !element.FirstChildElement(r.name.c_str()) &&
          !has_path(element, r.unless)) {
        add(XmlFaultKind::kMissingElement, element, r.name, element.GetLineNum(),
            tag(rule.name) + " without " + tag(r.name), "that element", rule);
      }
    }
  }

  void check_child(const XMLElement& child, const XMLElement& parent, const XmlRule& parent_rule) const {
    const auto known = std::find_if(parent_rule.children.begin(), parent_rule.children.end(),
                                    [&](const XmlRule& r) { return r.name == child.Name(); });
    if (known == parent_rule.children.end()) {
      add(XmlFaultKind::kUnknownElement, child, {}, child.GetLineNum(),
          "the unknown element " + tag(child.Name()) + " in " + tag(parent_rule.name),
          alternatives(parent_rule.children, "nothing"), parent_rule, names_of(parent_rule.children));
      return;
    }
    const XMLElement* first = parent.FirstChildElement(child.Name());
    if (known->count != XmlCount::kRepeated && first != &child) {
      add(XmlFaultKind::kSecondElement, child, {}, child.GetLineNum(),
          "a second " + tag(child.Name()) + " (the first is in line " + std::to_string(first->GetLineNum()) +
              ")",
          "one in " + tag(parent_rule.name), *known);
      return;
    }
    check(child, *known);
  }

  void check_content(const XMLElement& element, const XmlRule& rule) const {
    if (const XMLElement* child = element.FirstChildElement()) {
      add(XmlFaultKind::kUnknownElement, *child, {}, child->GetLineNum(),
          "the element " + tag(child->Name()) + " in " + tag(rule.name), "a value", rule);
    }
    const char* text = element.GetText();
    if (const Permitted permitted(rule); !permitted.holds(text ? text : "")) {
      const Value value = describe_value(tag(rule.name), text ? text : "", permitted);
      add(XmlFaultKind::kValue, element, {}, element.GetLineNum(), value.found, value.expected, rule);
    }
  }

  template <class Rule>
  static std::vector<std::string> names_of(const std::vector<Rule>& rules) {
    std::vector<std::string> names;
    for (const Rule& rule : rules) names.push_back(rule.name);
    return names;
  }

  template <class Rule>
  static std::string alternatives(const std::vector<Rule>& rules, const std::string& none) {
    return rules.empty() ? none : join_alternatives(names_of(rules));
  }

  const std::filesystem::path& file_;
  std::vector<XmlFault>& faults_;
};

}  // namespace

std::vector<XmlFault> find_xml_faults(const XmlNode& node, const XmlRule& rule) {
  std::vector<XmlFault> faults;
  Checker(node.file(), faults).check(node.element(), rule);
  return faults;
}

}  // namespace koboshi
