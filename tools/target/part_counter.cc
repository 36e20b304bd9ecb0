#include "tools/target/part_counter.h"

#include <filesystem>
#include <limits>
#include <stdexcept>

#include <fmt/core.h>

namespace koboshi::tools {
namespace {

constexpr const char* kPlugin = "count_by_part.so";
constexpr const char* kService = "app::Controller::service";
constexpr const char* kTick = "app::Controller::tick";
constexpr int kPartOfCaller = -1;

// The part of the innermost function that belongs to one.
int part_number(const nlohmann::ordered_json& functions) {
  for (const auto& function : functions) {
    if (const auto part = part_of(function.get<std::string>())) return static_cast<int>(*part);
  }
  return kPartOfCaller;
}

std::filesystem::path find_plugin() {
  const auto plugin = std::filesystem::read_symlink("/proc/self/exe").parent_path() / kPlugin;
  if (!std::filesystem::exists(plugin)) {
    throw std::runtime_error(plugin.string() + " is missing, which is built with this program");
  }
  return plugin;
}

}  // namespace

PartCounter::PartCounter(const nlohmann::ordered_json& image) {
  const std::filesystem::path table = folder_.path() / "code";
  const std::filesystem::path counts = folder_.path() / "counts";
  const auto address_of = [&](const char* call) {
    return image.at("by_entry_point").at(call).at("address").get<std::uint64_t>();
  };
  service_address_ = address_of(kService);
  tick_address_ = address_of(kTick);
  std::ofstream file(table);
  for (const auto& stretch : image.at("code")) {
    const auto address = stretch.at("address").get<std::uint64_t>();
    file << fmt::format("{} {} {} {}\n", address, stretch.at("size_bytes").get<std::uint64_t>(),
                        part_number(stretch.at("of")),
                        address == service_address_ || address == tick_address_ ? 1 : 0);
  }
  std::ofstream(counts).close();  // so that the file exists before the plugin writes it
  counts_.open(counts);
  arguments_ = {"-plugin",
                fmt::format("{},code={},counts={}", find_plugin().string(), table.string(), counts.string())};
}

PartCounts PartCounter::next(std::uint64_t root_address) {
  counts_.clear();  // the file has grown since the end was reached
  std::uint64_t address = 0;
  counts_ >> address;
  PartCounts counts{};
  for (std::uint64_t& count : counts) counts_ >> count;
  counts_.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  if (!counts_ || address != root_address) {
    throw std::runtime_error("the instructions of a call were not counted");
  }
  return counts;
}

}  // namespace koboshi::tools
