#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace koboshi {

struct XmlAttributePlace {
  std::string name{};
  std::size_t begin = 0;        // of the name
  std::size_t value_begin = 0;  // between the quotes
  std::size_t value_end = 0;
  std::size_t end = 0;  // after the quote
};

// Where an element stands in a text, in bytes.
struct XmlPlace {
  std::string name{};
  std::size_t begin = 0;           // of the start tag
  std::size_t attributes_end = 0;  // after the name and the attributes
  std::size_t content_begin = 0;   // after the start tag
  std::size_t content_end = 0;     // before the end tag
  std::size_t end = 0;             // after the end tag
  bool is_short = false;           // <name/>
  std::vector<XmlAttributePlace> attributes{};
  std::vector<XmlPlace> elements{};
};

// Finds the root element of a text that parse_xml() accepts. Throws InputError for a document type
// declaration and for what it cannot follow.
[[nodiscard]] XmlPlace locate_xml(std::string_view text, const std::filesystem::path& source);

}  // namespace koboshi
