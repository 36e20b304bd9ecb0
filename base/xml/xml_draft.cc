#include "base/xml/xml_draft.h"

#include <tinyxml2.h>

#include <string_view>

#include "base/xml/xml_parse.h"

namespace koboshi {
namespace {

using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

// The draft owns the document, so that it may change what its nodes only show.
XMLElement& changeable(const XmlNode& node) { return const_cast<XMLElement&>(node.element()); }

std::string quoted_tag(std::string_view name) { return "<" + one_line(name) + ">"; }

}  // namespace

XmlDraft::XmlDraft(std::filesystem::path file, const std::string& text, const XmlRule& root_rule)
    : path_(std::move(file)), document_(std::make_unique<tinyxml2::XMLDocument>()) {
  parse_xml_text(*document_, text, path_);
  const XMLElement* root = document_->RootElement();
  if (!root) throw InputError(path_, 1, "no element", quoted_tag(root_rule.name));
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

}  // namespace koboshi
