#include "tools/target/part_counter.h"

#include <stdlib.h>

#include <limits>
#include <stdexcept>

#include <fmt/core.h>

namespace koboshi::tools {
namespace {

constexpr const char* kPlugin = "count_by_part.so";
constexpr const char* kService = "app::Controller::service";
constexpr const char* kTick = "app::Controller::tick";
constexpr int kPartOfCaller = -1;

std::filesystem::path find_plugin() {
  const auto plugin = std::filesystem::read_symlink("/proc/self/exe").parent_path() / kPlugin;
  if (!std::filesystem::exists(plugin)) {
    throw std::runtime_error(plugin.string() + " is missing, which is built with this program");
  }
  return plugin;
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string name = std::filesystem::temp_directory_path() / "koboshi-XXXXXX";
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a folder " + name);
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

PartCounter::PartCounter(const nlohmann::ordered_json& functions) {
  const std::filesystem::path table = folder_.path() / "functions";
  const std::filesystem::path counts = folder_.path() / "counts";
  std::ofstream file(table);
  for (const auto& function : functions) {
    const auto name = function.at("name").get<std::string>();
    const auto address = function.at("address").get<std::uint64_t>();
    if (name == kService) service_address_ = address;
    if (name == kTick) tick_address_ = address;
    const auto part = part_of(name);
    file << fmt::format("{} {} {} {}\n", address, function.at("size_bytes").get<std::uint64_t>(),
                        part ? static_cast<int>(*part) : kPartOfCaller,
                        name == kService || name == kTick ? 1 : 0);
  }
  if (service_address_ == 0 || tick_address_ == 0)
    throw std::runtime_error("the image lacks service or tick");
  std::ofstream(counts).close();  // so that it can be opened before the plugin writes it
  counts_.open(counts);
  arguments_ = {"-plugin", fmt::format("{},functions={},counts={}", find_plugin().string(), table.string(),
                                       counts.string())};
}

PartCounts PartCounter::next(std::uint64_t root_address) {
  counts_.clear();  // it has grown since it was last at its end
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
