#pragma once

#include <string>
#include <vector>

#include "sim_board/input/text.h"

namespace koboshi::sim {

// Schema of a kind of XML file. Elements and attributes without a rule are errors.

enum class XmlCount { kOptional, kRequired, kRepeated };

enum class XmlContent {
  kChildren,  // elements only, those of the rule
  kText,      // not empty
  kNumbers,   // as many as the rule requires, finite and within its range
  kInteger,
  kAnything  // not checked
};

struct XmlAttributeRule {
  std::string name;
  XmlContent content = XmlContent::kText;
  bool required = true;
  NumberRange range = {};
};

struct XmlRule {
  std::string name;
  XmlContent content = XmlContent::kChildren;
  XmlCount count = XmlCount::kOptional;
  std::vector<XmlAttributeRule> attributes = {};
  std::vector<XmlRule> children = {};
  std::size_t numbers = 1;
  NumberRange range = {};
};

}  // namespace koboshi::sim
