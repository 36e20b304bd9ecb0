#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/text/error.h"

namespace tinyxml2 {
class XMLElement;
}  // namespace tinyxml2

namespace koboshi {

// An element of an XmlFile that has passed its schema, or of an XmlDraft; it must not outlive the document.
// Accessors do not repeat the schema's checks: access to something that the schema does not require is a
// programming error and asserts.
class XmlNode {
 public:
  XmlNode(const tinyxml2::XMLElement& element, const std::filesystem::path& file)
      : element_(&element), file_(&file) {}

  std::string name() const;
  int line() const;
  const std::filesystem::path& file() const { return *file_; }
  const tinyxml2::XMLElement& element() const { return *element_; }
  bool operator==(const XmlNode& other) const { return element_ == other.element_; }

  // Names of the elements from the root to this one.
  std::vector<std::string> path() const;
  // Numbers of the child elements that lead from the root to this element; empty: the root itself.
  std::vector<std::size_t> place() const;
  // Returns nothing for the root.
  std::optional<XmlNode> parent() const;

  XmlNode child(const std::string& name) const;
  std::optional<XmlNode> find(const std::string& name) const;
  std::vector<XmlNode> children(const std::string& name) const;

  std::string text() const;
  std::vector<double> numbers() const;
  // Number in the child with this name.
  double number(const std::string& child_name) const;
  double number(const std::string& child_name, double fallback) const;

  std::string attribute(const std::string& name) const;
  std::optional<std::string> find_attribute(const std::string& name) const;
  double attribute_number(const std::string& name, double fallback) const;
  std::int64_t attribute_integer(const std::string& name) const;
  std::int64_t attribute_integer(const std::string& name, std::int64_t fallback) const;

  // Returns an error at this element's line, for the caller to throw.
  InputError error(const std::string& found, const std::string& expected) const;

 private:
  const tinyxml2::XMLElement* element_;
  const std::filesystem::path* file_;
};

}  // namespace koboshi
