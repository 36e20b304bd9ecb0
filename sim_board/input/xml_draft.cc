#include "sim_board/input/xml_draft.h"

#include <tinyxml2.h>

#include <cctype>
#include <string_view>

namespace koboshi::sim {
namespace {

using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

// Returns "XML error: mismatched element" for tinyxml2's XML_ERROR_MISMATCHED_ELEMENT.
std::string describe_error(const tinyxml2::XMLDocument& document) {
  std::string name = document.ErrorName();
  constexpr std::string_view kPrefix = "XML_ERROR_";
  if (name.starts_with(kPrefix)) name.erase(0, kPrefix.size());
  for (char& c : name) c = c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return "XML error: " + name;
}

// The draft owns the document, so that it may change what its nodes only show.
XMLElement& changeable(const XmlNode& node) { return const_cast<XMLElement&>(node.element()); }

std::string quoted_tag(std::string_view name) { return "<" + one_line(name) + ">"; }

}  // namespace

XmlDraft::XmlDraft(std::filesystem::path file, const std::string& text, const XmlRule& root_rule)
    : path_(std::move(file)), document_(std::make_unique<tinyxml2::XMLDocument>()) {
  if (document_->Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    throw InputError(path_, document_->ErrorLineNum(), describe_error(*document_), "well-formed XML");
  }
  const XMLElement* root = document_->RootElement();
  if (!root) throw InputError(path_, 0, "no element", quoted_tag(root_rule.name));
  if (root->Name() != root_rule.name) {
    throw InputError(path_, root->GetLineNum(), quoted_tag(root->Name()), quoted_tag(root_rule.name));
  }
  if (root->NextSiblingElement()) {
    throw InputError(path_, root->NextSiblingElement()->GetLineNum(), "a second root element", "one");
  }
}

XmlDraft::~XmlDraft() = default;

XmlNode XmlDraft::root() const { return XmlNode(*document_->RootElement(), path_); }

std::string XmlDraft::text() const {
  tinyxml2::XMLPrinter printer;
  document_->Print(&printer);
  return printer.CStr();
}

void XmlDraft::set_text(const XmlNode& node, const std::string& text) {
  changeable(node).SetText(text.c_str());
}

void XmlDraft::set_attribute(const XmlNode& node, const std::string& name, const std::string& value) {
  changeable(node).SetAttribute(name.c_str(), value.c_str());
}

void XmlDraft::rename(const XmlNode& node, const std::string& name) {
  changeable(node).SetName(name.c_str());
}

void XmlDraft::erase(const XmlNode& node) {
  XMLElement& element = changeable(node);
  element.Parent()->DeleteChild(&element);
}

void XmlDraft::erase_attribute(const XmlNode& node, const std::string& name) {
  changeable(node).DeleteAttribute(name.c_str());
}

void XmlDraft::erase_texts(const XmlNode& node) {
  XMLElement& element = changeable(node);
  for (XMLNode* child = element.FirstChild(); child;) {
    XMLNode* next = child->NextSibling();
    if (child->ToText()) element.DeleteChild(child);
    child = next;
  }
}

}  // namespace koboshi::sim
