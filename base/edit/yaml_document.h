#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/edit/yaml_places.h"
#include "base/yaml/yaml_tree.h"

namespace koboshi {

// The keys and item numbers that lead to a value.
class YamlPath {
 public:
  YamlPath() = default;  // of the root
  // Splits a dotted path, as in `--set`: steps.3.pose.left_knee.
  YamlPath(std::string_view dotted);  // NOLINT(google-explicit-constructor): a path is written as text
  YamlPath(const char* dotted) : YamlPath(std::string_view(dotted)) {}  // NOLINT(google-explicit-constructor)
  // The steps themselves, for keys with dots.
  explicit YamlPath(std::vector<std::string> steps) : steps_(std::move(steps)) {}

  const std::vector<std::string>& steps() const { return steps_; }
  std::string text() const;  // dotted

 private:
  std::vector<std::string> steps_;
};

// An edit of one value, see the functions of YamlDocument.
struct YamlEdit {
  enum class Kind { kSet, kErase, kRename };

  Kind kind = Kind::kSet;
  YamlPath path;
  std::string text;  // the value; of kRename the key; of kErase nothing
};

// Items of a list, or entries of a map, that follow each other.
struct YamlItems {
  YamlPath collection;
  std::size_t first = 0;
  std::size_t count = 0;
};

// A YAML file that programs change and people keep reading: an edit replaces the bytes of one value, and
// every other byte, comment and order stays as written.
//
// A value is YAML on one
// line, in flow style: 12.5, "text", [1, 2], {left_knee: 30}. All functions throw InputError for a path
// or a value that does not fit, and leave the document unchanged: after each edit the text is parsed again
// and must contain exactly the intended change.
class YamlDocument {
 public:
  // Reads a file.
  explicit YamlDocument(std::filesystem::path file);
  // Uses a text. Messages name `source`.
  YamlDocument(std::filesystem::path source, std::string text);

  const std::string& text() const { return text_; }
  const YamlNode& tree() const { return tree_; }

  // Replaces a value. A key that its map lacks is added as the map's last one.
  void set(const YamlPath& path, std::string_view value);
  // Inserts an item before the one at `path`, whose last step is a number; the list's length appends. The
  // comment lines directly above an item stay with it.
  void insert(const YamlPath& path, std::string_view value);
  // Removes a key with its value, or an item of a list. Comments on lines of their own stay.
  void erase(const YamlPath& path);
  // Renames the last key of a path.
  void rename(const YamlPath& path, std::string_view key);

  // Makes several edits at once, which costs as much as one. They must be about different values of the
  // document as it is, and may not erase items of lists.
  void edit(std::span<const YamlEdit> edits);

  // The following functions work on blocks of text: some items of a list, or entries of a map, in block style
  // from column 0 on, with the comment lines directly above each.

  // Returns such a block of the document. `collection`: path of the list or map.
  [[nodiscard]] std::string items_text(const YamlPath& collection, std::size_t first,
                                       std::size_t count) const;
  // Inserts a block before an item; the number of items appends. An empty list or map becomes one in block
  // style, one in flow style takes the items in that style, without comments.
  void insert_items(const YamlPath& collection, std::size_t index, std::string_view block);
  // Removes items, with the comment lines between and directly above them or without. The runs are in the
  // order of the text, and none lies within another.
  enum class Comments { kKeep, kErase };
  void erase_items(std::span<const YamlItems> runs, Comments comments);

  // Replaces items, with the comment lines that belong to them.
  void replace_items(const YamlItems& run, std::string_view block);

  // Replaces the whole text. Throws InputError if it is no YAML.
  void replace_text(std::string text);

  // Where the values stand in the text. Throws InputError as the edits do.
  const YamlPlace& places() const;

  // Replaces the file atomically. Throws WriteError.
  void save() const;

 private:
  // Bytes from begin to end become `text`.
  struct Change {
    std::size_t begin;
    std::size_t end;
    std::string text;
  };

  Change set_change(const YamlPath& path, std::string_view value, YamlNode& intended) const;
  Change insert_change(const YamlPath& path, std::string_view value, YamlNode& intended) const;
  Change erase_change(const YamlPath& path, YamlNode& intended) const;
  Change rename_change(const YamlPath& path, std::string_view key, YamlNode& intended) const;
  void add_erasure(const YamlItems& run, Comments comments, YamlNode& intended,
                   std::vector<Change>& changes) const;
  void apply(std::vector<Change> changes, YamlNode intended);

  std::filesystem::path source_;
  std::string text_;
  YamlNode tree_;
  mutable std::optional<YamlPlace> places_;
};

}  // namespace koboshi
