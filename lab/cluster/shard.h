#pragma once

#include <compare>
#include <cstddef>
#include <filesystem>
#include <string>

namespace koboshi::lab {

// One of several programs that share the trials of an experiment or of a search, each in a file of its own.
struct Shard {
  std::size_t number = 1;  // 1 to count
  std::size_t count = 1;

  friend auto operator<=>(const Shard&, const Shard&) = default;
};

inline constexpr std::size_t kMaxShards = 100'000;

// "3/8". Throws std::invalid_argument.
[[nodiscard]] Shard parse_shard(const std::string& text);

// The file of a shard's finished trials: shard-3-of-8.jsonl.
[[nodiscard]] std::filesystem::path shard_file(const std::filesystem::path& folder, const Shard& shard);

// A shard's part of `total` items in a row. The parts are consecutive and differ by at most one item.
struct ShardRange {
  std::size_t begin = 0;
  std::size_t end = 0;  // the first item that is not part of it
};
[[nodiscard]] ShardRange range_of(const Shard& shard, std::size_t total);
// The number, from 1, of the shard of which an item is a part.
[[nodiscard]] std::size_t shard_of(std::size_t item, std::size_t total, std::size_t count);

}  // namespace koboshi::lab
