#pragma once

#include <filesystem>
#include <string_view>

namespace tinyxml2 {
class XMLDocument;
}  // namespace tinyxml2

namespace koboshi {

// Parses a text into a document. Throws InputError, with a line, for text that is not UTF-8 or not
// well-formed XML, and for elements nested more deeply than tinyxml2 permits. Errors name `file`.
void parse_xml_text(tinyxml2::XMLDocument& document, std::string_view text,
                    const std::filesystem::path& file);

}  // namespace koboshi
