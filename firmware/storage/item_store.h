#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/fixed/contract.h"
#include "firmware/storage/item.h"
#include "hal/port/storage.h"

namespace koboshi::storage {

// Items that a device writes itself, at the end of its storage. Each item occupies a slot of its own, and a
// new version goes into a free slot, so that a power failure at any time leaves either the old or the new
// version complete.
//
//   slot: the item's bytes from the start; at the end a trailer, written last: magic u32, kind u16, number
//   u16, sequence u32, size u32 of the item, reserved u32, CRC-32 u32 of the item and of the trailer before
//   it; little-endian. Of two slots with the same item the higher sequence counts.
//
// One item is written at a time, by one writer: `begin`, until it returns kOk, then `append`, `flush`,
// `written` and `commit` as needed, and `release`. The functions in between require that `begin` has returned
// kOk and `release` has not been called since. No function waits for the flash: it returns kBusy, has done
// nothing, and is to be called again (docs/decision/0010-parameters-in-flash.md).
class ItemStore {
 public:
  static constexpr std::size_t kTrailerSize = 24;
  static constexpr std::size_t kMaxSlots = 64;
  // The most bytes of one `append`: a page, less what may wait in it for the rest of its write unit.
  static constexpr std::size_t kMaxAppendSize =
      hal::StoragePort::kMaxWriteSize - (hal::StoragePort::kWriteUnit_bytes - 1);

  struct Layout {
    std::size_t slot_size_bytes;  // a multiple of the storage's sectors
    std::size_t slots;            // one more than there are items; at most kMaxSlots

    constexpr std::size_t size_bytes() const { return slot_size_bytes * slots; }
    constexpr std::size_t max_item_size_bytes() const { return slot_size_bytes - kTrailerSize; }
  };

  // Reads all slots. A storage smaller than the layout has no slots: it stores nothing. The storage's sectors
  // must divide the slots. `storage` must outlive the store.
  ItemStore(hal::StoragePort& storage, const Layout& layout);

  // The bytes of an item, in place; empty when there is none.
  std::span<const std::byte> find(ItemKind kind, std::uint16_t number) const;

  // Begins an item: kBusy while its slot is being erased, kInUse while another item is being written, kFull
  // without a free slot. kFailed here and below when the flash fails.
  Status begin(ItemKind kind, std::uint16_t number);
  // Appends all of these bytes, at most kMaxAppendSize, or none: kBusy while there is no room for them,
  // kTooLong beyond max_item_size_bytes().
  Status append(std::span<const std::byte> bytes);
  // Ends the appending. Once it returns kOk, all bytes are in flash and `written` shows them.
  Status flush();
  std::span<const std::byte> written() const {
    KOBOSHI_ASSERT(begun_);
    return slot(slot_).first(size_);
  }
  // Once it returns kOk, `find` finds the new version. To be repeated until then.
  Status commit();
  // Ends what `begin` has begun; without `commit`, nothing has changed. No effect if nothing has begun.
  void release();

  // To be called once a millisecond.
  void process() {
    if (operating_ || state_ == State::kOpen) advance();
  }

 private:
  enum class State : std::uint8_t {
    kIdle,
    kErasing,  // for the next call of `begin`
    kErased,
    kOpen,
    kSealing,  // the trailer is being written
    kSealed,
    kFailed,
  };
  struct Trailer;

  static constexpr std::size_t kWriteUnit = hal::StoragePort::kWriteUnit_bytes;

  std::span<const std::byte> slot(std::size_t number) const;
  std::size_t slot_offset(std::size_t number) const { return first_ + number * layout_.slot_size_bytes; }
  bool occupied(std::size_t number) const { return (occupied_ >> number & 1) != 0; }
  bool read(std::size_t number, Trailer& trailer) const;
  void take(std::size_t number, const Trailer& trailer);
  bool choose_slot();
  void erase_next();
  void write(std::size_t offset, std::span<const std::byte> bytes);
  void write_page(std::size_t size);
  void write_trailer();
  void advance();
  void on_done();

  hal::StoragePort& storage_;
  const Layout layout_;
  std::size_t first_;           // offset of the first slot
  std::uint64_t occupied_ = 0;  // bit i: slot i holds the valid version of an item
  std::uint32_t sequence_ = 0;  // the highest
  std::size_t slot_ = 0;        // written last, or being written
  State state_ = State::kIdle;
  bool begun_ = false;      // between `begin` and `release`
  bool operating_ = false;  // a flash operation of this store is running
  ItemKind kind_{};
  std::uint16_t number_ = 0;
  std::uint32_t crc_ = 0;      // of the bytes appended
  std::size_t done_ = 0;       // bytes of the slot that are erased, or written
  std::size_t size_ = 0;       // bytes appended
  std::size_t page_fill_ = 0;  // bytes appended that wait in the page
  std::array<std::byte, hal::StoragePort::kMaxWriteSize> page_;
};

// The robot's own items: parameters, and motions that replace those of the factory's catalogue
// (docs/decision/0010-parameters-in-flash.md). A slot holds a motion of seventy poses of twenty joints; the
// last two slots are for the parameters and for the next version of any item.
inline constexpr ItemStore::Layout kRobotLayout{.slot_size_bytes = 6 * 1024, .slots = kMaxMotions + 2};
static_assert(kRobotLayout.slots <= ItemStore::kMaxSlots);

}  // namespace koboshi::storage
