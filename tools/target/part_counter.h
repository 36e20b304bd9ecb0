#pragma once

#include <array>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "base/file/temporary_folder.h"
#include "tools/target/parts.h"

namespace koboshi::tools {

// Instructions in a call of the firmware, by Part.
using PartCounts = std::array<std::uint64_t, kPartNames.size()>;

// Counts the firmware's instructions by part while QEMU executes the image, through a plugin of QEMU
// (plugin/count_by_part.cc).
class PartCounter {
 public:
  // `image` is its description. Throws std::runtime_error when the plugin is not beside this program.
  explicit PartCounter(const nlohmann::ordered_json& image);

  // Arguments for QEMU.
  const std::vector<std::string>& arguments() const { return arguments_; }
  // Instructions of the next call of service or tick, which has returned. Ask in the order of the calls:
  // throws std::runtime_error when the next call was the other.
  PartCounts next_service() { return next(service_address_); }
  PartCounts next_tick() { return next(tick_address_); }

 private:
  PartCounts next(std::uint64_t root_address);

  TemporaryFolder folder_;  // for the files that the plugin reads and writes
  std::vector<std::string> arguments_;
  std::uint64_t service_address_ = 0;
  std::uint64_t tick_address_ = 0;
  std::ifstream counts_;
};

}  // namespace koboshi::tools
