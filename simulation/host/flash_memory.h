#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

#include "hal/flash/flash_model.h"

namespace koboshi::simulation {

// The flash of a robot's board. In a file it outlives the program, and whatever ends the program, as flash
// does: each write is in the file at once.
class FlashMemory {
 public:
  static constexpr std::size_t kSize_bytes = hal::FlashModel::kSize_bytes;

  // With these contents from its start on, where the factory puts them; behind them, what the file holds of
  // an earlier robot's life (storage::ItemStore), or nothing. Without a file it lasts as long as this object.
  // Throws std::length_error when the contents do not fit, sim::InputError for a file that is no such flash.
  explicit FlashMemory(std::span<const std::byte> contents, const std::filesystem::path& file = {});

  [[nodiscard]] std::span<std::byte, kSize_bytes> bytes() {
    return std::span<std::byte, kSize_bytes>(bytes_.get(), kSize_bytes);
  }

 private:
  struct Unmap {
    void operator()(std::byte* bytes) const;
  };

  std::unique_ptr<std::byte, Unmap> bytes_;
};

}  // namespace koboshi::simulation
