#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "base/xml/xml_node.h"
#include "base/xml/xml_schema.h"

namespace tinyxml2 {
class XMLDocument;
}  // namespace tinyxml2

namespace koboshi {

// An XML document that may violate its schema (find_xml_faults() lists how) and can be repaired. Nodes keep
// the lines of the original text.
class XmlDraft {
 public:
  // Throws InputError if the text is not well-formed or its root is another element than that of the rule.
  // Errors name `file`.
  XmlDraft(std::filesystem::path file, const std::string& text, const XmlRule& root_rule);
  XmlDraft(const XmlDraft&) = delete;
  XmlDraft& operator=(const XmlDraft&) = delete;
  ~XmlDraft();

  const std::filesystem::path& path() const { return path_; }
  XmlNode root() const;
  // The document as a text, with its changes.
  std::string text() const;

  // Changes. They are not checked, and nodes below an erased one become invalid.
  void set_text(const XmlNode& node, const std::string& text);
  void set_attribute(const XmlNode& node, const std::string& name, const std::string& value);
  void rename(const XmlNode& node, const std::string& name);
  void erase(const XmlNode& node);
  void erase_attribute(const XmlNode& node, const std::string& name);
  // Erases texts between the node's children.
  void erase_texts(const XmlNode& node);

 private:
  std::filesystem::path path_;
  std::unique_ptr<tinyxml2::XMLDocument> document_;
};

}  // namespace koboshi
