#pragma once

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace koboshi {

// The file or the command-line option that set a value. All values of a document share it: an editor copies
// thousands of them for each edit.
class YamlSource {
 public:
  YamlSource() = default;
  explicit YamlSource(std::filesystem::path path)
      : path_(std::make_shared<const std::filesystem::path>(std::move(path))) {}

  const std::filesystem::path& path() const {
    static const std::filesystem::path kNone;
    return path_ ? *path_ : kNone;
  }
  bool operator==(const YamlSource& other) const { return path() == other.path(); }

 private:
  std::shared_ptr<const std::filesystem::path> path_;
};

// A value of a YAML document with its location.
struct YamlNode {
  enum class Kind { kNull, kScalar, kMap, kList };

  Kind kind = Kind::kNull;
  YamlSource source;
  int line = 0;        // of the key, in a map; 0: from the command line
  int column = 0;      // of the key, in a map; from 1
  int value_line = 0;  // of the value itself
  int value_column = 0;
  std::string path;  // dotted path from the root: pushes[0].force_N; empty at the root
  std::string key;   // in the parent map
  std::string scalar;
  bool quoted = false;                  // a quoted 7 is text, not a number
  std::vector<YamlNode> items;          // of a map or a list, in file order
  mutable std::set<std::string> asked;  // keys of this map that the reader has requested

  const YamlNode* find(const std::string& name) const;
};

// An override `--set PATH=VALUE`, which replaces or adds a value of the file. The path is dotted, list items
// are numbered (pushes.0.force_N), and the value is YAML in flow style.
struct Override {
  std::string path;
  std::string value;
  std::string option = "--set";  // option named in messages, such as --seed
};

// Parses "ground.mu=0.5". Throws InputError with --set instead of a file.
Override parse_override(const std::string& argument);

// An override by this text, whatever characters it has. An empty text gives an override without a value.
Override text_override(std::string path, const std::string& text, std::string option);

// Parses one document whose root is a map. Throws InputError for text that is not UTF-8, malformed YAML, a
// second document, a duplicate key, a key that is not plain text or no name (name_fault()), an alias, a tag,
// or more than 100 nested maps and lists.
YamlNode parse_yaml(const std::string& text, const std::filesystem::path& source);

// Writes a document that parse_yaml reads back with the same values: the root's keys and the items of their
// lists in block style, everything else in flow style.
std::string yaml_text(const YamlNode& root);

// Applies an override. Throws InputError if the path leads through a value that is not a map, or if the value
// is malformed. Unknown keys are detected later, like those of the file.
void apply_override(YamlNode& root, const Override& override_value);

}  // namespace koboshi
