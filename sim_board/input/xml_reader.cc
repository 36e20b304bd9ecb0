#include "sim_board/input/xml_reader.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cassert>
#include <cctype>
#include <string_view>

namespace koboshi::sim {
namespace {

using tinyxml2::XMLAttribute;
using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

// Parses finite numbers separated by blanks. Returns nothing if any word is not a number.
std::optional<std::vector<double>> parse_numbers(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  std::vector<double> values;
  for (auto begin = text.find_first_not_of(kBlanks); begin != std::string_view::npos;) {
    const auto end = std::min(text.find_first_of(kBlanks, begin), text.size());
    const auto value = parse_number(text.substr(begin, end - begin));
    if (!value) return std::nullopt;
    values.push_back(*value);
    begin = text.find_first_not_of(kBlanks, end);
  }
  return values;
}

std::string tag(std::string_view name) { return "<" + one_line(name) + ">"; }

// Checks elements against their rules.
class Checker {
 public:
  explicit Checker(const std::filesystem::path& file) : file_(file) {}

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
  [[noreturn]] void fail(int line, const std::string& found, const std::string& expected) const {
    throw InputError(file_, line, found, expected);
  }

  void check_attributes(const XMLElement& element, const XmlRule& rule) const {
    for (const XMLAttribute* attribute = element.FirstAttribute(); attribute; attribute = attribute->Next()) {
      const auto known = std::find_if(rule.attributes.begin(), rule.attributes.end(),
                                      [&](const XmlAttributeRule& r) { return r.name == attribute->Name(); });
      if (known == rule.attributes.end()) {
        fail(attribute->GetLineNum(),
             "the unknown attribute " + one_line(attribute->Name()) + " of " + tag(rule.name),
             alternatives(rule.attributes, "no attribute"));
      }
      check_value(attribute->GetLineNum(), known->name, attribute->Value(), *known, 1);
    }
    for (const XmlAttributeRule& r : rule.attributes) {
      if (r.required && !element.Attribute(r.name.c_str())) {
        fail(element.GetLineNum(), tag(rule.name) + " without " + r.name, "that attribute");
      }
    }
  }

  void check_children(const XMLElement& element, const XmlRule& rule) const {
    for (const XMLNode* node = element.FirstChild(); node; node = node->NextSibling()) {
      if (node->ToText()) {
        fail(node->GetLineNum(), "the text " + one_line(node->Value()) + " in " + tag(rule.name),
             alternatives(rule.children, "nothing"));
      }
      if (const XMLElement* child = node->ToElement()) check_child(*child, element, rule);
    }
    for (const XmlRule& r : rule.children) {
      if (r.count == XmlCount::kRequired && !element.FirstChildElement(r.name.c_str())) {
        fail(element.GetLineNum(), tag(rule.name) + " without " + tag(r.name), "that element");
      }
    }
  }

  void check_child(const XMLElement& child, const XMLElement& parent, const XmlRule& parent_rule) const {
    const auto known = std::find_if(parent_rule.children.begin(), parent_rule.children.end(),
                                    [&](const XmlRule& r) { return r.name == child.Name(); });
    if (known == parent_rule.children.end()) {
      fail(child.GetLineNum(), "the unknown element " + tag(child.Name()) + " in " + tag(parent_rule.name),
           alternatives(parent_rule.children, "nothing"));
    }
    const XMLElement* first = parent.FirstChildElement(child.Name());
    if (known->count != XmlCount::kRepeated && first != &child) {
      fail(child.GetLineNum(),
           "a second " + tag(child.Name()) + " (the first is in line " + std::to_string(first->GetLineNum()) +
               ")",
           "one in " + tag(parent_rule.name));
    }
    check(child, *known);
  }

  void check_content(const XMLElement& element, const XmlRule& rule) const {
    if (const XMLElement* child = element.FirstChildElement()) {
      fail(child->GetLineNum(), "the element " + tag(child->Name()) + " in " + tag(rule.name), "a value");
    }
    const char* text = element.GetText();
    check_value(element.GetLineNum(), tag(rule.name), text ? text : "", rule, rule.numbers);
  }

  // `rule`: of an element or an attribute, whose value has `numbers` numbers.
  template <class Rule>
  void check_value(int line, const std::string& name, const std::string& text, const Rule& rule,
                   std::size_t numbers) const {
    if (!is_valid(text, rule, numbers))
      fail(line, name + " = " + one_line(text),
           describe_values(rule.content, numbers, rule.range, rule.choices));
  }

  template <class Rule>
  static bool is_valid(const std::string& text, const Rule& rule, std::size_t numbers) {
    const auto within = [&](double v) { return v >= rule.range.min && v <= rule.range.max; };
    switch (rule.content) {
      case XmlContent::kText:
        return rule.choices.empty() ? !text.empty() : is_choice(text, rule.choices);
      case XmlContent::kInteger: {
        const auto value = parse_integer(text);
        if (!value || !within(static_cast<double>(*value))) return false;
        return rule.choices.empty() || is_choice(std::to_string(*value), rule.choices);
      }
      case XmlContent::kNumbers: {
        const auto values = parse_numbers(text);
        return values && values->size() == numbers && std::all_of(values->begin(), values->end(), within);
      }
      case XmlContent::kChildren:
      case XmlContent::kAnything:
        break;
    }
    return true;
  }

  static bool is_choice(const std::string& text, const std::vector<std::string>& choices) {
    return std::find(choices.begin(), choices.end(), text) != choices.end();
  }

  template <class Rule>
  static std::string alternatives(const std::vector<Rule>& rules, const std::string& none) {
    std::vector<std::string> names;
    for (const Rule& rule : rules) names.push_back(rule.name);
    return names.empty() ? none : join_alternatives(names);
  }

  const std::filesystem::path& file_;
};

// Returns "XML error: mismatched element" for tinyxml2's XML_ERROR_MISMATCHED_ELEMENT.
std::string describe_error(const tinyxml2::XMLDocument& document) {
  std::string name = document.ErrorName();
  constexpr std::string_view kPrefix = "XML_ERROR_";
  if (name.starts_with(kPrefix)) name.erase(0, kPrefix.size());
  for (char& c : name) c = c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return "XML error: " + name;
}

}  // namespace

std::string XmlNode::name() const { return element_->Name(); }

int XmlNode::line() const { return element_->GetLineNum(); }

XmlNode XmlNode::child(const std::string& name) const {
  const auto found = find(name);
  assert(found);
  return *found;
}

std::optional<XmlNode> XmlNode::find(const std::string& name) const {
  const XMLElement* element = element_->FirstChildElement(name.c_str());
  return element ? std::optional(XmlNode(*element, *file_)) : std::nullopt;
}

std::vector<XmlNode> XmlNode::children(const std::string& name) const {
  std::vector<XmlNode> all;
  for (const XMLElement* element = element_->FirstChildElement(name.c_str()); element;
       element = element->NextSiblingElement(name.c_str())) {
    all.emplace_back(*element, *file_);
  }
  return all;
}

std::string XmlNode::text() const {
  const char* text = element_->GetText();
  return text ? text : "";
}

std::vector<double> XmlNode::numbers() const { return parse_numbers(text()).value(); }

double XmlNode::number(const std::string& child_name) const { return child(child_name).numbers().front(); }

double XmlNode::number(const std::string& child_name, double fallback) const {
  const auto found = find(child_name);
  return found ? found->numbers().front() : fallback;
}

std::string XmlNode::attribute(const std::string& name) const { return find_attribute(name).value(); }

std::optional<std::string> XmlNode::find_attribute(const std::string& name) const {
  const char* value = element_->Attribute(name.c_str());
  return value ? std::optional<std::string>(value) : std::nullopt;
}

double XmlNode::attribute_number(const std::string& name, double fallback) const {
  const auto value = find_attribute(name);
  return value ? parse_number(*value).value() : fallback;
}

std::int64_t XmlNode::attribute_integer(const std::string& name) const {
  return parse_integer(attribute(name)).value();
}

std::int64_t XmlNode::attribute_integer(const std::string& name, std::int64_t fallback) const {
  return find_attribute(name) ? attribute_integer(name) : fallback;
}

InputError XmlNode::error(const std::string& found, const std::string& expected) const {
  return InputError(*file_, line(), found, expected);
}

std::string xml_root_name(const std::filesystem::path& file) {
  const std::string text = read_text_file(file, "an XML file");
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) return {};
  const XMLElement* root = document.RootElement();
  return root ? root->Name() : std::string();
}

XmlFile::XmlFile(std::filesystem::path file, const XmlRule& root_rule)
    : XmlFile(file, read_text_file(file, "an XML file"), root_rule) {}

XmlFile::XmlFile(std::filesystem::path file, const std::string& text, const XmlRule& root_rule)
    : path_(std::move(file)), document_(std::make_unique<tinyxml2::XMLDocument>()) {
  if (document_->Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    throw InputError(path_, document_->ErrorLineNum(), describe_error(*document_), "well-formed XML");
  }
  const XMLElement* root = document_->RootElement();
  if (!root) throw InputError(path_, 0, "no element", tag(root_rule.name));
  if (root->Name() != root_rule.name) {
    throw InputError(path_, root->GetLineNum(), tag(root->Name()), tag(root_rule.name));
  }
  if (root->NextSiblingElement()) {
    throw InputError(path_, root->NextSiblingElement()->GetLineNum(), "a second root element", "one");
  }
  Checker(path_).check(*root, root_rule);
}

XmlFile::~XmlFile() = default;

XmlNode XmlFile::root() const { return XmlNode(*document_->RootElement(), path_); }

}  // namespace koboshi::sim
