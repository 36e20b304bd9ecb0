#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace koboshi::sim {

// A value of a YAML document with the place it came from.
struct YamlNode {
  enum class Kind { kNull, kScalar, kMap, kList };

  Kind kind = Kind::kNull;
  std::filesystem::path source;  // the file, or the option of the command line that set the value
  int line = 0;                  // 0: from the command line
  std::string path;              // dotted, from the root: pushes[0].force_N; empty at the root
  std::string key;               // within the parent map
  std::string scalar;
  bool quoted = false;                  // a quoted 7 is text, not a number
  std::vector<YamlNode> items;          // of a map or a list, in the file's order
  mutable std::set<std::string> asked;  // keys of this map that the reader knows of

  const YamlNode* find(const std::string& name) const;
};

// A value that replaces or adds one of the file, from the option `--set PATH=VALUE`: a dotted path, list
// items by number (pushes.0.force_N), and YAML in flow style.
struct Override {
  std::string path;
  std::string value;
  std::string option = "--set";  // that messages name, such as --seed
};

// From "ground.mu=0.5". Throws InputError with --set in the place of the file.
Override parse_override(const std::string& argument);

// One document whose root is a map. Throws InputError at malformed YAML, a second document, a doubled key, a
// key that is not plain text, an alias, or a tag.
YamlNode parse_yaml(const std::string& text, const std::filesystem::path& source);

// A document that parse_yaml reads as the same values: the keys of the root below each other, the items of
// their lists too, all else in flow style.
std::string yaml_text(const YamlNode& root);

// Throws InputError if the path leads through something that is no map, or the value is malformed. A key that
// nobody knows is found later, like one in the file.
void apply_override(YamlNode& root, const Override& override_value);

}  // namespace koboshi::sim
