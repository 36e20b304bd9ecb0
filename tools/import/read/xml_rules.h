#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/xml/xml_schema.h"

namespace koboshi::tools {

// Rules of foreign files. Their values are parsed by numbers_in(), which says what it expects; unlike the
// rules of our own files they state no ranges and no notes.

inline XmlRule element(std::string name, XmlCount count, std::vector<XmlAttributeRule> attributes,
                       std::vector<XmlRule> children = {}) {
  return {.name = std::move(name),
          .count = count,
          .attributes = std::move(attributes),
          .children = std::move(children)};
}

// An element whose text is a value.
inline XmlRule value_element(std::string name, XmlCount count = XmlCount::kOptional) {
  XmlRule rule = element(std::move(name), count, {});
  rule.content = XmlContent::kAnything;
  return rule;
}

inline XmlAttributeRule value_attribute(std::string name, bool required = true) {
  return {.name = std::move(name), .content = XmlContent::kAnything, .required = required};
}

inline XmlAttributeRule name_attribute(std::string name, bool required = true) {
  return {.name = std::move(name), .content = XmlContent::kText, .required = required};
}

}  // namespace koboshi::tools
