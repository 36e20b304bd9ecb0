#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/xml/xml_schema.h"

namespace koboshi::tools {

// The simple types of an XML Schema: one for each set of permitted values, named after it, such as
// number_from_0_to_1.
class XsdTypes {
 public:
  // `prefix`: of the schema's own name space, "koboshi:" or empty.
  explicit XsdTypes(std::string prefix) : prefix_(std::move(prefix)) {}

  // Returns the qualified name of the type for these values and adds its definition.
  std::string type_of(XmlContent content, std::size_t numbers, const NumberRange& range,
                      const std::vector<std::string>& choices);
  // All definitions, in the order of their names, indented by two blanks.
  std::string definitions() const;

 private:
  std::string prefix_;
  std::map<std::string, std::string> definitions_;  // by name
};

}  // namespace koboshi::tools
