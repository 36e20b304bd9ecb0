#include <algorithm>
#include <array>
#include <memory>

#include "firmware/storage/item_store.h"
#include "hal/flash/flash_model.h"
#include "tests/fuzz/fuzz_input.h"

// A flash with any contents in its log: the fuzzer's bytes come at the begin of each of its sectors, a few of
// which are chosen by the first byte. What the store finds lies inside the flash, and it can store an item,
// find it, and erase it again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  using storage::Status;
  static constexpr std::size_t kLog = 8 * hal::FlashModel::kSectorSize_bytes;
  static const auto memory = std::make_unique<std::array<std::byte, hal::FlashModel::kSize_bytes>>();
  memory->fill(std::byte{0xFF});  // erased
  fuzz::Numbers numbers({data, size});
  const std::uint8_t sectors = numbers.byte();
  const auto bytes = std::as_bytes(numbers.rest()).first(std::min(numbers.rest().size(), kLog));
  for (std::size_t i = 0; i < 8; ++i) {
    if ((sectors >> i & 1) == 0) continue;
    const auto begin =
        memory->end() - static_cast<std::ptrdiff_t>(kLog - i * hal::FlashModel::kSectorSize_bytes);
    std::copy_n(bytes.begin(), std::min<std::ptrdiff_t>(std::ssize(bytes), memory->end() - begin), begin);
  }
  hal::FlashModel flash(*memory);
  storage::ItemStore store(flash, kLog);
  const auto inside = [&](std::span<const std::byte> item) {
    return item.empty() ||
           (item.data() >= memory->data() && item.data() + item.size() <= memory->data() + memory->size());
  };
  for (std::uint16_t number = 0; number < storage::kMaxMotions; ++number) {
    if (!inside(store.find(storage::ItemKind::kMotion, number))) __builtin_trap();
  }
  const auto repeated = [&](auto call) {
    for (int i = 0; i < 20'000; ++i) {
      store.process();
      if (const Status status = call(); status != Status::kBusy) return status;
    }
    __builtin_trap();
  };
  const std::array<std::byte, 24> item{std::byte{1}};
  Status status = repeated([&] { return store.begin(storage::ItemKind::kMotion, 3, item.size()); });
  if (status != Status::kOk) return 0;  // the flash is full of what it found
  status = repeated([&] { return store.append(item); });
  if (status == Status::kOk) status = repeated([&] { return store.commit(); });
  store.release();
  if (status != Status::kOk) __builtin_trap();
  if (!std::ranges::equal(store.find(storage::ItemKind::kMotion, 3), item)) __builtin_trap();
  status = repeated([&] { return store.erase(storage::ItemKind::kMotion, 3); });
  if (status != Status::kOk || !store.find(storage::ItemKind::kMotion, 3).empty()) __builtin_trap();
  return 0;
}
