#include "tools/import/write/sdf_parts.h"

#include <tinyxml2.h>

#include <string_view>

#include "base/text/text.h"

namespace koboshi::tools {

std::string part_at_line(const std::filesystem::path& sdf, int line) {
  tinyxml2::XMLDocument document;
  if (line <= 0 || document.LoadFile(sdf.c_str()) != tinyxml2::XML_SUCCESS) return {};
  const tinyxml2::XMLElement* const model = document.RootElement()->FirstChildElement("model");
  if (model == nullptr) return {};
  std::string part;  // of the last element that begins before the line
  for (const auto* element = model->FirstChildElement(); element != nullptr;
       element = element->NextSiblingElement()) {
    if (element->GetLineNum() > line) break;
    const std::string_view kind = element->Name();
    const char* const name = element->Attribute("name");
    const bool is_part = (kind == "link" || kind == "joint") && name != nullptr;
    part = is_part ? std::string(kind) + " " + one_line(name) : std::string();
  }
  return part;
}

}  // namespace koboshi::tools
