#pragma once

#include <filesystem>
#include <string>

#include "base/xml/xml_draft.h"
#include "base/xml/xml_node.h"
#include "base/xml/xml_schema.h"

namespace koboshi {

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

  const std::filesystem::path& path() const { return draft_.path(); }
  XmlNode root() const { return draft_.root(); }

 private:
  XmlDraft draft_;
};

}  // namespace koboshi
