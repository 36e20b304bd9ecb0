#include "base/xml/xml_node.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cassert>

#include "base/xml/xml_schema.h"

namespace koboshi {

using tinyxml2::XMLElement;

std::vector<std::string> XmlNode::path() const {
  std::vector<std::string> names;
  for (const XMLElement* element = element_; element; element = element->Parent()->ToElement())
    names.emplace_back(element->Name());
  std::reverse(names.begin(), names.end());
  return names;
}

std::vector<std::size_t> XmlNode::place() const {
  std::vector<std::size_t> numbers;
  for (const XMLElement* element = element_; element->Parent()->ToElement();
       element = element->Parent()->ToElement()) {
    numbers.push_back(0);
    for (const XMLElement* before = element->PreviousSiblingElement(); before;
         before = before->PreviousSiblingElement()) {
      ++numbers.back();
    }
  }
  std::reverse(numbers.begin(), numbers.end());
  return numbers;
}

std::optional<XmlNode> XmlNode::parent() const {
  const XMLElement* element = element_->Parent()->ToElement();
  return element ? std::optional(XmlNode(*element, *file_)) : std::nullopt;
}

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

}  // namespace koboshi
