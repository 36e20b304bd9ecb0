#include "base/xml/xml_parse.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cctype>
#include <string>

#include "base/text/error.h"
#include "base/text/text.h"

namespace koboshi {
namespace {

// Returns "XML error: mismatched element" for tinyxml2's XML_ERROR_MISMATCHED_ELEMENT.
std::string describe_error(const tinyxml2::XMLDocument& document) {
  std::string name = document.ErrorName();
  for (const std::string_view prefix : {"XML_", "ERROR_"})
    if (name.starts_with(prefix)) name.erase(0, prefix.size());
  for (char& c : name) c = c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return "XML error: " + name;
}

}  // namespace

void parse_xml_text(tinyxml2::XMLDocument& document, std::string_view text,
                    const std::filesystem::path& file) {
  require_utf8(text, file);
  const tinyxml2::XMLError error = document.Parse(text.data(), text.size());
  const int line = std::max(document.ErrorLineNum(), 1);
  switch (error) {
    case tinyxml2::XML_SUCCESS:
      return;
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      throw InputError(file, line, "an empty file", "an XML element");
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED: {
      const std::string limit = std::to_string(TINYXML2_MAX_ELEMENT_DEPTH);
      throw InputError(file, line, "elements nested deeper than " + limit + " levels",
                       "at most " + limit + " levels");
    }
    default:
      throw InputError(file, line, describe_error(document), "well-formed XML");
  }
}

}  // namespace koboshi
