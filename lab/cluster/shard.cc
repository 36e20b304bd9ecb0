#include "lab/cluster/shard.h"

#include <charconv>
#include <stdexcept>
#include <string_view>

#include "base/text/text.h"

namespace koboshi::lab {
namespace {

bool read_count(std::string_view text, std::size_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && value >= 1 && value <= kMaxShards;
}

}  // namespace

Shard parse_shard(const std::string& text) {
  Shard shard;
  const std::size_t slash = text.find('/');
  const std::string_view whole = text;
  if (slash == std::string::npos || !read_count(whole.substr(0, slash), shard.number) ||
      !read_count(whole.substr(slash + 1), shard.count) || shard.number > shard.count) {
    throw std::invalid_argument("found the shard " + one_line(text) + ", expected K/N, with K from 1 to N");
  }
  return shard;
}

std::filesystem::path shard_file(const std::filesystem::path& folder, const Shard& shard) {
  return folder / ("shard-" + std::to_string(shard.number) + "-of-" + std::to_string(shard.count) + ".jsonl");
}

ShardRange range_of(const Shard& shard, std::size_t total) {
  return {total * (shard.number - 1) / shard.count, total * shard.number / shard.count};
}

std::size_t shard_of(std::size_t item, std::size_t total, std::size_t count) {
  // The inverse of range_of, whose ends are rounded down.
  return ((item + 1) * count - 1) / total + 1;
}

}  // namespace koboshi::lab
