#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/xml/xml_reader.h"
#include "base/xml/xml_schema.h"

namespace koboshi {

enum class XmlFaultKind {
  kUnknownElement,    // the node itself
  kUnknownAttribute,  // `name`
  kMissingElement,    // `name`, a child
  kMissingAttribute,  // `name`
  kSecondElement,     // the node itself
  kValue,             // the node's text
  kAttributeValue,    // that of the attribute `name`
  kText               // between the node's children
};

// A violation of a schema.
struct XmlFault {
  XmlFaultKind kind;
  XmlNode node;
  std::string name;                        // empty for faults of the node itself
  int line;                                // of the fault, which may be below the node's
  std::string found;                       // as in InputError
  std::string expected;                    // as in InputError
  std::vector<std::string> names;          // those that are permitted instead of an unknown one
  const XmlRule* rule;                     // of the node; of its parent for kUnknownElement
  const XmlAttributeRule* attribute_rule;  // for kAttributeValue; null otherwise

  InputError error(const std::filesystem::path& file) const { return {file, line, found, expected}; }
};

// Compares an element with its rule. Returns all violations in the order in which a reader meets them: those
// of attributes, then of the children, then what is missing. Unknown and second elements are not entered.
std::vector<XmlFault> find_xml_faults(const XmlNode& node, const XmlRule& rule);

}  // namespace koboshi
