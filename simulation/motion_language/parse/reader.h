#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text/text.h"
#include "base/yaml/yaml_tree.h"
#include "simulation/motion_language/parse/diagnostic.h"

namespace koboshi::simulation {

// Reads a YAML tree and collects the errors instead of stopping at the first one. Each accessor returns
// nothing after it has reported an error.
class Reader {
 public:
  explicit Reader(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  Diagnostics& diagnostics() { return diagnostics_; }

  // The place of a map's entry is its key, that of a list's item its value.
  [[nodiscard]] static Place key_place(const YamlNode& node);
  [[nodiscard]] static Place value_place(const YamlNode& node);

  void error(const char* code, Place place, std::string found, std::string expected, std::string hint = {},
             std::string limit = {});
  // An error about the value of this node.
  void bad_value(const YamlNode& node, const std::string& expected, std::string hint = {});

  [[nodiscard]] std::optional<double> number(const YamlNode& node, const NumberRange& range = {});
  [[nodiscard]] std::optional<std::int64_t> integer(const YamlNode& node, const IntegerRange& range = {});
  [[nodiscard]] std::optional<std::string> text(const YamlNode& node);
  [[nodiscard]] std::optional<std::string> one_of(const YamlNode& node,
                                                  const std::vector<std::string>& names);
  [[nodiscard]] bool is_map(const YamlNode& node);   // reports another kind
  [[nodiscard]] bool is_list(const YamlNode& node);  // the same

  // Returns the value of a key; reports a missing one and returns nullptr.
  [[nodiscard]] const YamlNode* require(const YamlNode& map, const std::string& key,
                                        const std::string& expected);
  // Reports each key that is not among `known`.
  void check_keys(const YamlNode& map, const std::vector<std::string>& known);

 private:
  Diagnostics& diagnostics_;
};

}  // namespace koboshi::simulation
