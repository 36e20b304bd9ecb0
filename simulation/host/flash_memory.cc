#include "simulation/host/flash_memory.h"

#include <fcntl.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "firmware/storage/item_store.h"
#include "hal/linux/file_descriptor.h"
#include "sim_board/input/error.h"

namespace koboshi::simulation {
namespace {

constexpr std::byte kErased{0xFF};

// Until version 0.1 the file contained 34 slots of 6 KiB at its end, each with a trailer that began so.
constexpr std::size_t kOldSlots = 34;
constexpr std::size_t kOldSlotSize_bytes = 6 * 1024;
constexpr std::size_t kOldTrailerSize_bytes = 24;
constexpr std::string_view kOldTrailer = "KITM";

bool has_old_slots(std::span<const std::byte> flash) {
  for (std::size_t slot = 0; slot < kOldSlots; ++slot) {
    const auto trailer =
        flash.last(slot * kOldSlotSize_bytes + kOldTrailerSize_bytes).first(kOldTrailer.size());
    if (std::memcmp(trailer.data(), kOldTrailer.data(), kOldTrailer.size()) == 0) return true;
  }
  return false;
}

// Extends the file to the size of the flash. Returns true if the file was created.
bool make_long_enough(const std::filesystem::path& file) {
  const std::uintmax_t size = std::filesystem::file_size(file);
  if (size == FlashMemory::kSize_bytes) return false;
  if (size != 0) {
    throw sim::InputError(file, 0, std::to_string(size) + " bytes",
                          "a storage of " + std::to_string(FlashMemory::kSize_bytes) + ", or no file yet");
  }
  std::filesystem::resize_file(file, FlashMemory::kSize_bytes);
  return true;
}

std::byte* map(int file_number) {
  const int flags = file_number >= 0 ? MAP_SHARED : MAP_PRIVATE | MAP_ANONYMOUS;
  void* const bytes =
      ::mmap(nullptr, FlashMemory::kSize_bytes, PROT_READ | PROT_WRITE, flags, file_number, 0);
  hal::checked(bytes == MAP_FAILED ? -1 : 0, "memory for the storage");
  return static_cast<std::byte*>(bytes);
}

}  // namespace

FlashMemory::FlashMemory(std::span<const std::byte> contents, const std::filesystem::path& file) {
  constexpr std::size_t kFactory_bytes = kSize_bytes - storage::kRobotLogSize_bytes;
  if (contents.size() > kFactory_bytes) {
    throw std::length_error("model and motions take " + std::to_string(contents.size()) +
                            " bytes, more than the storage's " + std::to_string(kFactory_bytes));
  }
  bool fresh = true;
  hal::FileDescriptor opened;
  if (!file.empty()) {
    opened = hal::FileDescriptor(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
    if (opened.number() < 0)
      throw sim::InputError(file, 0, std::strerror(errno), "a file that can be written");
    fresh = make_long_enough(file);
  }
  bytes_.reset(map(opened.number()));
  if (!fresh && has_old_slots(bytes())) {
    throw sim::InputError(file, 0, "items in slots of 6 KiB, as an earlier version stored them",
                          "a storage of this version, or no file yet");
  }
  std::ranges::fill(bytes().first(fresh ? kSize_bytes : kFactory_bytes), kErased);
  std::ranges::copy(contents, bytes().begin());
}

void FlashMemory::Unmap::operator()(std::byte* bytes) const { ::munmap(bytes, kSize_bytes); }

}  // namespace koboshi::simulation
