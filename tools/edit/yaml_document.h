#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim_board/input/yaml_tree.h"

namespace koboshi::tools {

// The keys and item numbers that lead to a value.
class YamlPath {
 public:
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

// A YAML file that programs change and people keep reading: an edit replaces the bytes of one value, and
// every other byte, comment and order stays as written.
//
// A value is YAML on one
// line, in flow style: 12.5, "text", [1, 2], {left_knee: 30}. All functions throw sim::InputError for a path
// or a value that does not fit, and leave the document unchanged: after each edit the text is parsed again
// and must contain exactly the intended change.
class YamlDocument {
 public:
  // Reads a file.
  explicit YamlDocument(std::filesystem::path file);
  // Uses a text. Messages name `source`.
  YamlDocument(std::filesystem::path source, std::string text);

  const std::string& text() const { return text_; }
  const sim::YamlNode& tree() const { return tree_; }

  // Replaces a value. A key that its map lacks is added as the map's last one.
  void set(const YamlPath& path, std::string_view value);
  // Inserts an item before the one at `path`, whose last step is a number; the list's length appends. The
  // comment lines directly above an item stay with it.
  void insert(const YamlPath& path, std::string_view value);
  // Removes a key with its value, or an item of a list. Comments on lines of their own stay.
  void erase(const YamlPath& path);
  // Renames the last key of a path.
  void rename(const YamlPath& path, std::string_view key);

  // Replaces the file atomically. Throws sim::WriteError.
  void save() const;

 private:
  struct Change;

  void apply(const Change& change, const sim::YamlNode& intended);

  std::filesystem::path source_;
  std::string text_;
  sim::YamlNode tree_;
};

}  // namespace koboshi::tools
