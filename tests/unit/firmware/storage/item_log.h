#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "firmware/storage/item_store.h"
#include "tests/unit/firmware/storage/cut_flash.h"

namespace koboshi::storage {

using Bytes = std::vector<std::byte>;

inline constexpr std::size_t kSectorSize = 2048;
inline constexpr std::size_t kMotionSize = 592;                 // of 12 poses of 20 joints
inline constexpr std::size_t kParameterSize = 1'000;            // more than all of the controller's take
inline constexpr std::uint16_t kParameterNumber = kMaxMotions;  // how these tests number the parameters

inline Bytes pattern(std::size_t size, unsigned seed) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i * 13 + i / 256 + seed);
  return bytes;
}

// A store, and the items that it should contain.
class Log {
 public:
  Log(std::size_t size_bytes, std::size_t sector_size, std::uint32_t seed = 1)
      : flash(size_bytes, sector_size, seed), size_(size_bytes) {
    store.emplace(flash, size_);
  }

  // Writes an item, and returns nothing if power fails meanwhile.
  std::optional<Status> write(std::uint16_t number, const Bytes& bytes) {
    attempted_ = {number, bytes};
    std::optional<Status> status = repeat([&] { return begin(number, bytes.size()); });
    for (std::size_t i = 0; i < bytes.size() && status == Status::kOk; i += ItemStore::kMaxAppendSize) {
      const auto piece =
          std::span(bytes).subspan(i, std::min<std::size_t>(ItemStore::kMaxAppendSize, bytes.size() - i));
      status = repeat([&] { return store->append(piece); });
    }
    if (status == Status::kOk) status = repeat([&] { return store->commit(); });
    if (status) store->release();
    if (status == Status::kOk) items[number] = bytes;
    return status;
  }
  std::optional<Status> erase(std::uint16_t number) {
    attempted_ = {number, {}};
    const auto status = repeat([&] { return store->erase(kind(number), index(number)); });
    if (status == Status::kOk) items.erase(number);
    return status;
  }
  Status begin(std::uint16_t number, std::size_t size) {
    return store->begin(kind(number), index(number), size);
  }
  // Repeats the call until the flash is ready.
  template <typename Verb>
  std::optional<Status> repeat(const Verb& verb) {
    for (int i = 0; i < 20'000; ++i) {
      const Status status = verb();
      if (flash.is_off()) return std::nullopt;
      if (status != Status::kBusy) return status;
      store->process();
      if (flash.is_off()) return std::nullopt;
    }
    ADD_FAILURE() << "the store does not end";
    return std::nullopt;
  }
  void process(int times) {
    for (int i = 0; i < times; ++i) store->process();
  }
  Bytes item(std::uint16_t number) const {
    const auto found = store->find(kind(number), index(number));
    return {found.begin(), found.end()};
  }
  // After a power failure the item that was being written is either the old or the new one.
  void restart() {
    flash.power_on();
    store.emplace(flash, size_);
    const Bytes found = item(attempted_.first);
    if (found == attempted_.second) {
      items[attempted_.first] = found;
      if (found.empty()) items.erase(attempted_.first);
    }
  }
  bool is_as_expected() const {
    for (std::uint16_t number = 0; number <= kParameterNumber; ++number) {
      const auto expected = items.find(number);
      if (item(number) != (expected == items.end() ? Bytes() : expected->second)) return false;
    }
    return true;
  }

  test::CutFlash flash;
  std::optional<ItemStore> store;
  std::map<std::uint16_t, Bytes> items;

 private:
  static ItemKind kind(std::uint16_t number) {
    return number == kParameterNumber ? ItemKind::kParameters : ItemKind::kMotion;
  }
  static std::uint16_t index(std::uint16_t number) { return number == kParameterNumber ? 0 : number; }

  std::size_t size_;
  std::pair<std::uint16_t, Bytes> attempted_;
};

}  // namespace koboshi::storage
