#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

#include "hal/flash/flash_model.h"

namespace koboshi::simulation {

// Flash memory of a robot's board. If backed by a file, it is persistent even when the program crashes: each
// write reaches the file at once.
class FlashMemory {
 public:
  static constexpr std::size_t kSize_bytes = hal::FlashModel::kSize_bytes;

  // Starts with `contents`, which is where the factory writes them. The rest comes from the file
  // (storage::ItemStore) or is erased. Without a file the memory is volatile. Throws std::length_error if the
  // contents do not fit and InputError if the file is not a flash image that this class has written, or
  // one of an earlier version.
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
