#include "simulation/host/flash_memory.h"

#include <fcntl.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "base/text/error.h"
#include "firmware/storage/catalogue.h"
#include "firmware/storage/image.h"
#include "firmware/storage/item_store.h"
#include "hal/linux/file_descriptor.h"

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
    throw InputError(file, 0, std::to_string(size) + " bytes",
                     "a storage of " + std::to_string(FlashMemory::kSize_bytes) + ", or no file yet");
  }
  std::filesystem::resize_file(file, FlashMemory::kSize_bytes);
  return true;
}

// The factory contents begin with a catalogue, of whichever version of the program.
bool has_catalogue(std::span<const std::byte> flash) {
  using enum storage::ImageStatus;
  storage::Image image;
  const auto found = storage::open_image(flash, storage::kCatalogueMagic, storage::kCatalogueVersion, image);
  return found == kOk || found == kBadVersion;
}

// The header of a record ends with the CRC-32 of the bytes before it (ItemStore).
bool has_record(std::span<const std::byte> log) {
  constexpr std::size_t kChecked = storage::ItemStore::kHeaderSize - 4;
  for (std::size_t start = 0; start + storage::ItemStore::kHeaderSize <= log.size();
       start += hal::StoragePort::kWriteUnit_bytes) {
    const auto header = log.subspan(start, storage::ItemStore::kHeaderSize);
    if (storage::crc32(header.first(kChecked)) == storage::ImageReader(header.subspan(kChecked)).u32())
      return true;
  }
  return false;
}

// Whether so few bytes have been written that a program which ended in the middle of its first item may have
// left them.
bool is_nearly_erased(std::span<const std::byte> log) {
  const auto written =
      static_cast<std::size_t>(std::ranges::count_if(log, [](std::byte byte) { return byte != kErased; }));
  return written <= storage::ItemStore::kMaxItemSize_bytes + hal::FlashModel::kSectorSize_bytes;
}

bool is_erased(std::span<const std::byte> flash) {
  return std::ranges::all_of(flash, [](std::byte byte) { return byte == kErased; });
}

// Throws InputError unless a run has written the file.
void check_origin(std::span<const std::byte> flash, const std::filesystem::path& file) {
  constexpr const char* kExpected = "a storage that a run has written, or no file yet";
  const auto log = flash.last(storage::kRobotLogSize_bytes);
  // A program that ended before it had written its contents leaves an erased header.
  if (!has_catalogue(flash) && !is_erased(flash.first(storage::kImageHeaderSize)))
    throw InputError(file, 0, "contents without a catalogue of items", kExpected);
  if (!has_record(log) && !is_nearly_erased(log))
    throw InputError(file, 0, "a log without a single record", kExpected);
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
    if (opened.number() < 0) throw InputError(file, 0, std::strerror(errno), "a file that can be written");
    fresh = make_long_enough(file);
  }
  bytes_.reset(map(opened.number()));
  if (!fresh && has_old_slots(bytes())) {
    throw InputError(file, 0, "items in slots of 6 KiB, as an earlier version stored them",
                     "a storage of this version, or no file yet");
  }
  if (!fresh) check_origin(bytes(), file);
  std::ranges::fill(bytes().first(fresh ? kSize_bytes : kFactory_bytes), kErased);
  std::ranges::copy(contents, bytes().begin());
}

void FlashMemory::Unmap::operator()(std::byte* bytes) const { ::munmap(bytes, kSize_bytes); }

}  // namespace koboshi::simulation
