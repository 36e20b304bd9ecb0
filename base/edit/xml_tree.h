#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace koboshi {

struct XmlAttribute {
  std::string name{};
  std::string value{};  // entities resolved

  bool operator==(const XmlAttribute&) const = default;
};

// A part of an XML file: an element, or what stands between elements. Blanks between elements are no part.
struct XmlPart {
  enum class Kind { kElement, kText, kComment, kOther };

  Kind kind = Kind::kElement;
  std::string name{};  // of an element
  std::string text{};  // of the other kinds; entities of a text are resolved
  int line = 0;
  std::vector<XmlAttribute> attributes{};
  std::vector<XmlPart> parts{};

  bool is_element() const { return kind == Kind::kElement; }
  // Returns the value of an attribute, nullptr without it.
  const std::string* attribute(std::string_view attribute_name) const;
  // Returns the child elements in the order of the file; a path counts these.
  std::vector<const XmlPart*> elements() const;
  std::size_t element_count() const;
  // Returns the index in `parts` of the child element with this number, at most element_count(); the number
  // itself gives the end.
  std::size_t part_index(std::size_t element) const;
  // Returns the text of an element without child elements; empty without text.
  std::string content() const;
};

// Whether two trees have the same elements, attributes, texts and comments, on whatever lines.
[[nodiscard]] bool same_parts(const XmlPart& a, const XmlPart& b);

// Parses a whole file with the parser of the reader of robots (base/xml/xml_reader.h). The result
// contains the file's parts, of which exactly one is an element. Throws InputError, naming `source`.
[[nodiscard]] XmlPart parse_xml(std::string_view text, const std::filesystem::path& source);

}  // namespace koboshi
