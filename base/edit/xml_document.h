#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/edit/xml_places.h"
#include "base/edit/xml_tree.h"

namespace koboshi {

// Numbers of the child elements that lead from the root element to an element; empty: the root itself.
using XmlPath = std::vector<std::size_t>;

// An XML file that programs change and people keep reading: an edit replaces the bytes of one value, and
// every other byte, comment and order stays as written.
//
// All functions throw InputError for a path or a value that does not fit, and leave the document
// unchanged: after each edit the text is parsed again and must contain exactly the intended change.
class XmlDocument {
 public:
  // Reads a file.
  explicit XmlDocument(std::filesystem::path file);
  // Uses a text. Messages name `source`.
  XmlDocument(std::filesystem::path source, std::string text);

  const std::filesystem::path& source() const { return source_; }
  const std::string& text() const { return text_; }
  // The root element. Valid until the next edit.
  const XmlPart& root() const;
  // The element at a path, nullptr if there is none.
  const XmlPart* find(const XmlPath& path) const;
  // Where an element stands in the text.
  const XmlPlace& place(const XmlPath& path) const;

  // Replaces the text of an element that has no child elements. Blanks around a value are layout and stay;
  // those around a name belong to it and go.
  enum class Blanks { kStay, kGo };
  void set_text(const XmlPath& path, std::string_view value, Blanks blanks = Blanks::kStay);
  // Replaces the value of an attribute; an attribute that the element lacks is added as its last one.
  void set_attribute(const XmlPath& path, std::string_view name, std::string_view value);
  void erase_attribute(const XmlPath& path, std::string_view name);
  // Inserts an element, as one XML element in a text, before the child element `index` of a parent; the
  // number of child elements appends. It gets a line of its own if the sibling before it has one.
  void insert_element(const XmlPath& parent, std::size_t index, std::string_view xml);
  // Removes an element with its content; a line that it leaves blank goes, too.
  void erase_element(const XmlPath& path);
  // Replaces the whole text.
  void replace_text(std::string text);

  // Replaces the file atomically. Throws WriteError.
  void save() const;

 private:
  // Bytes from begin to end become `text`.
  struct Change {
    std::size_t begin = 0;
    std::size_t end = 0;
    std::string text{};
  };

  XmlPart& element_of(XmlPart& whole, const XmlPath& path) const;
  Change insertion(const XmlPlace& parent, std::size_t index, std::string_view xml) const;
  void apply(const Change& change, const XmlPart& intended);
  void take(std::string text, XmlPart parsed);
  std::string line_end() const;

  std::filesystem::path source_;
  std::string text_;
  XmlPart whole_;
  XmlPlace root_place_;
};

}  // namespace koboshi
