#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/yaml/yaml_tree.h"

namespace koboshi {

// Strict reader for all YAML files: a missing, malformed, duplicate, unknown, wrongly typed or out-of-range
// value is an InputError with file and line.
//
//   YamlFile file("scenarios/squat.yaml", overrides);
//   const YamlMap root = file.root();
//   root.require_version(1);
//   const double duration_s = root.number("duration_s", {.min = 0.01, .max = 3600});
//   for (const YamlValue& push : root.list("pushes")) read_push(push.map());
//   file.finish();  // every key that was not read is an error
//
// Maps, lists and values refer to their YamlFile and must not outlive it.

class YamlMap;

// Describes a value and its path for a message: "steps[0].time_s = 0", "poses, a list".
std::string describe_found(const YamlNode& node);

class YamlValue {
 public:
  explicit YamlValue(const YamlNode& node) : node_(&node) {}

  // Each accessor throws InputError unless the value has this type. Numbers are finite and unquoted.
  double number(const NumberRange& range = {}) const;
  std::int64_t integer(const IntegerRange& range = {}) const;
  bool boolean() const;      // true or false
  std::string text() const;  // a name, a path: as name_fault() permits
  std::string one_of(std::span<const std::string> names) const;
  YamlMap map() const;
  std::vector<YamlValue> list() const;
  std::vector<double> numbers(std::size_t count,
                              const NumberRange& range = {}) const;  // a list of exactly `count` numbers

  bool is_map() const { return node_->kind == YamlNode::Kind::kMap; }
  bool is_list() const { return node_->kind == YamlNode::Kind::kList; }
  // Source of the value: the file, or the option of the command line. The line of an option is 0.
  const std::filesystem::path& source() const { return node_->source.path(); }
  int line() const { return node_->line; }
  // Returns an error with this value and its path, for the caller to throw.
  InputError error(const std::string& expected) const;
  // Returns an error at this value's line with the caller's text.
  InputError error(const std::string& found, const std::string& expected) const;

 private:
  const YamlNode* node_;
};

class YamlMap {
 public:
  explicit YamlMap(const YamlNode& node) : node_(&node) {}

  // Returns the fallback if the key is missing; without a fallback, a missing key is an InputError.
  double number(const std::string& key, const NumberRange& range = {},
                std::optional<double> fallback = std::nullopt) const;
  std::int64_t integer(const std::string& key, const IntegerRange& range = {},
                       std::optional<std::int64_t> fallback = std::nullopt) const;
  bool boolean(const std::string& key, std::optional<bool> fallback = std::nullopt) const;
  std::string text(const std::string& key, std::optional<std::string> fallback = std::nullopt) const;
  std::string one_of(const std::string& key, const std::vector<std::string>& names,
                     std::optional<std::string> fallback = std::nullopt) const;
  std::vector<double> numbers(const std::string& key, std::size_t count, const NumberRange& range = {}) const;
  YamlMap child(const std::string& key) const;
  std::optional<YamlMap> optional_child(const std::string& key) const;
  // A missing list is an InputError; check has() first if it is optional.
  std::vector<YamlValue> list(const std::string& key) const;
  YamlValue value(const std::string& key) const;
  bool has(const std::string& key) const;
  // Returns every key of the map with its value, in the file's order, for maps whose keys are user-defined
  // names.
  std::vector<std::pair<std::string, YamlValue>> entries() const;
  // Checks the key `version`, which must have this value.
  void require_version(std::int64_t version) const;

  // Returns the line of a key, or of the map if the key is missing.
  int line_of(const std::string& key) const;
  // Returns an error at the key's line, for the caller to throw.
  InputError error_at(const std::string& key, const std::string& found, const std::string& expected) const;

 private:
  const YamlNode* find(const std::string& key) const;
  const YamlNode& require(const std::string& key, const std::string& expected) const;

  const YamlNode* node_;
};

class YamlFile {
 public:
  // Reads and parses the whole file, then applies the overrides in order. Throws InputError.
  explicit YamlFile(std::filesystem::path file, std::span<const Override> overrides = {});
  // Uses a document without a file. Messages name `source` instead.
  YamlFile(std::filesystem::path source, YamlNode document)
      : path_(std::move(source)), root_(std::move(document)) {}
  YamlFile(const YamlFile&) = delete;
  YamlFile& operator=(const YamlFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  YamlMap root() const { return YamlMap(root_); }
  // The whole document, including the overrides.
  const YamlNode& tree() const { return root_; }
  // Throws InputError at the first key that was never read.
  void finish() const;

 private:
  std::filesystem::path path_;
  YamlNode root_;
};

}  // namespace koboshi
