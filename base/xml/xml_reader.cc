#include "base/xml/xml_reader.h"

#include <tinyxml2.h>

#include "base/xml/xml_check.h"

namespace koboshi {

std::string xml_root_name(const std::filesystem::path& file) {
  const std::string text = read_text_file(file, "an XML file");
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) return {};
  const tinyxml2::XMLElement* root = document.RootElement();
  return root ? root->Name() : std::string();
}

XmlFile::XmlFile(std::filesystem::path file, const XmlRule& root_rule)
    : XmlFile(file, read_text_file(file, "an XML file"), root_rule) {}

XmlFile::XmlFile(std::filesystem::path file, const std::string& text, const XmlRule& root_rule)
    : draft_(std::move(file), text, root_rule) {
  const std::vector<XmlFault> faults = find_xml_faults(root(), root_rule);
  if (!faults.empty()) throw faults.front().error(path());
}

}  // namespace koboshi
