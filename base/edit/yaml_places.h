#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace koboshi {

// Where the values of a YAML document stand in its text, as offsets in bytes.
struct YamlPlace {
  enum class Kind { kScalar, kBlockText, kBlockMap, kBlockList, kFlowMap, kFlowList };

  Kind kind = Kind::kScalar;
  // The value from its first byte to after its last one, with quotes or brackets. An empty value begins and
  // ends after its colon or dash. A text in block style (| or >) ends after its last line.
  std::size_t begin = 0;
  std::size_t end = 0;
  // The key of a map's entry; empty for other values.
  std::string key;
  std::size_t key_begin = 0;
  std::size_t key_end = 0;
  std::vector<YamlPlace> items;

  bool is_map() const { return kind == Kind::kBlockMap || kind == Kind::kFlowMap; }
  bool is_list() const { return kind == Kind::kBlockList || kind == Kind::kFlowList; }
  bool is_flow() const { return kind == Kind::kFlowMap || kind == Kind::kFlowList; }
  bool is_block() const { return kind == Kind::kBlockMap || kind == Kind::kBlockList; }
};

// Locates the values of a document that parse_yaml accepts. Throws InputError, which names
// `source`, if libfyaml refuses it.
YamlPlace locate_yaml(std::string_view text, const std::filesystem::path& source);

}  // namespace koboshi
