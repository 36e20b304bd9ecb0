#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace koboshi::view {

// A batch as the page reads it.
struct ReadBatch {
  std::array<std::uint32_t, 8> head{};  // see Batch
  std::vector<double> times_us;
  std::string frames;
  std::vector<float> poses;
  std::vector<float> values;
  std::vector<std::uint32_t> counts;
  std::vector<float> contacts;
  nlohmann::json json;  // null without a text
};

// Reads the batches of a message.
inline std::vector<ReadBatch> read_batches(std::string_view message) {
  std::vector<ReadBatch> batches;
  const auto take = [&message](void* to, std::size_t bytes) {
    std::memcpy(to, message.substr(0, bytes).data(), bytes);
    message.remove_prefix(bytes);
  };
  const auto column = [&take](auto& numbers, std::size_t count) {
    numbers.resize(count);
    take(numbers.data(), count * sizeof numbers[0]);
  };
  while (message.size() >= 32) {
    ReadBatch& batch = batches.emplace_back();
    const std::size_t before = message.size();
    take(batch.head.data(), sizeof batch.head);
    const auto [size, json_size, samples, contacts, frames, links, signals, zero] = batch.head;
    column(batch.times_us, samples);
    column(batch.frames, 24 * frames);
    column(batch.poses, std::size_t{7} * links * samples);
    column(batch.values, std::size_t{signals} * samples);
    column(batch.counts, samples);
    column(batch.contacts, std::size_t{8} * contacts);
    std::string json;
    column(json, json_size);
    if (json.find_first_not_of(' ') != std::string::npos) batch.json = nlohmann::json::parse(json);
    if (before - message.size() != size || size % 8 != 0 || zero != 0) return {};
  }
  if (!message.empty()) return {};
  return batches;
}

}  // namespace koboshi::view
