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

// An element of an XmlFile that has passed its schema; it must not outlive the file. Accessors do not repeat
// the schema's checks: access to something that the schema does not require is a programming error and
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

// Returns the name of the file's root element, for readers of several kinds of file; empty if the file is
// malformed. Throws InputError if the file cannot be read.
std::string xml_root_name(const std::filesystem::path& file);

// Strict reader for all XML files. Malformed text, unknown, duplicate or missing elements and attributes, and
// malformed or out-of-range numbers are InputErrors with file and line.
class XmlFile {
 public:
  // Reads the whole file and checks it against the rule of its root element. Throws InputError.
  XmlFile(std::filesystem::path file, const XmlRule& root_rule);
  // Reads from a text instead; errors name `file`.
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
