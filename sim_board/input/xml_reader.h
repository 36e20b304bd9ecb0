#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_board/input/error.h"
#include "sim_board/input/xml_schema.h"

namespace tinyxml2 {
class XMLDocument;
class XMLElement;
}  // namespace tinyxml2

namespace koboshi::sim {

// An element of an XmlFile, which has passed its schema; it must not outlive the file. What the schema
// promises is not checked again: asking for what the schema does not require is a mistake of the program and
// asserts.
class XmlNode {
 public:
  XmlNode(const tinyxml2::XMLElement& element, const std::filesystem::path& file)
      : element_(&element), file_(&file) {}

  std::string name() const;
  int line() const;

  XmlNode child(const std::string& name) const;
  std::optional<XmlNode> find(const std::string& name) const;
  std::vector<XmlNode> children(const std::string& name) const;

  std::string text() const;
  std::vector<double> numbers() const;
  // Of the child with this name.
  double number(const std::string& child_name) const;
  double number(const std::string& child_name, double fallback) const;

  std::string attribute(const std::string& name) const;
  std::optional<std::string> find_attribute(const std::string& name) const;
  double attribute_number(const std::string& name, double fallback) const;
  std::int64_t attribute_integer(const std::string& name) const;
  std::int64_t attribute_integer(const std::string& name, std::int64_t fallback) const;

  // To throw at this element's line.
  InputError error(const std::string& found, const std::string& expected) const;

 private:
  const tinyxml2::XMLElement* element_;
  const std::filesystem::path* file_;
};

// What the file's root element is called, for a reader of more than one kind of file; empty where the file is
// malformed. Throws InputError where it cannot be read.
std::string xml_root_name(const std::filesystem::path& file);

// The strict reader of every XML file: malformed text, unknown or doubled elements and attributes, missing
// ones, bad numbers and numbers out of range are InputErrors with file and line.
class XmlFile {
 public:
  // Reads the whole file and holds it against the rule of its root element. Throws InputError.
  XmlFile(std::filesystem::path file, const XmlRule& root_rule);
  // The same of a text that is in no file, or not yet; errors name `file`.
  XmlFile(std::filesystem::path file, const std::string& text, const XmlRule& root_rule);
  XmlFile(const XmlFile&) = delete;
  XmlFile& operator=(const XmlFile&) = delete;
  ~XmlFile();

  const std::filesystem::path& path() const { return path_; }
  XmlNode root() const;

 private:
  std::filesystem::path path_;
  std::unique_ptr<tinyxml2::XMLDocument> document_;
};

}  // namespace koboshi::sim
