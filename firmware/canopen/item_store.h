#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/canopen/abort_code.h"
#include "hal/port/storage.h"

namespace koboshi::canopen {

// Items that a device writes itself, at the end of its storage; kind and number tell them apart. Each lies in
// a slot of its own, and a new version goes into a spare one, so that whenever power fails the old or the new
// is there as a whole:
//
//   slot: the item's bytes from the start on; at the end a trailer, written last: magic u32, kind u16, number
//   u16, sequence u32, size u32 of the item, reserved u32, CRC-32 u32 of the item and of the trailer before
//   it; little-endian. Of two slots with one item the higher sequence counts.
//
// One item is written at a time. Nothing here waits for the flash: a verb that would says kBusy, has done
// nothing, and is to be called again (docs/decision/0010-parameters-in-flash.md).
class ItemStore {
 public:
  static constexpr std::size_t kTrailerSize = 24;
  static constexpr std::size_t kMaxSlots = 64;

  struct Layout {
    std::size_t slot_size_bytes;  // a multiple of the storage's sectors; an item has kTrailerSize less
    std::size_t slots;            // one more than there are items; at most kMaxSlots

    constexpr std::size_t size_bytes() const { return slot_size_bytes * slots; }
  };

  // Looks through the slots. A storage of fewer bytes than the layout takes has none, and stores nothing.
  ItemStore(hal::StoragePort& storage, const Layout& layout);

  // The bytes of an item, where they lie in storage; empty where there is none.
  std::span<const std::byte> find(std::uint16_t kind, std::uint16_t number) const;

  // Begins an item: kBusy while the slot is being erased, kDeviceState while another is being written.
  // kHardwareError here and below when the flash fails; the next attempt takes another slot.
  AbortCode begin(std::uint16_t kind, std::uint16_t number);
  // The item's next bytes, all or none of them.
  AbortCode append(std::span<const std::byte> bytes);
  // Nothing is appended any more; once it is all in flash (kNone), `written` can be looked at.
  AbortCode flush();
  std::span<const std::byte> written() const { return slot(slot_).first(size_); }
  // From kNone on the item is the one that `find` finds.
  AbortCode commit();
  // Ends what `begin` has begun; without `commit`, nothing has happened.
  void release();

  // Once a millisecond.
  void process() {
    if (operating_ || state_ == State::kOpen) go_on();
  }

 private:
  void go_on();
  enum class State : std::uint8_t {
    kIdle,
    kErasing,  // for whoever begins first
    kErased,
    kOpen,
    kSealing,  // the trailer is being written
    kSealed,
    kFailed,
  };
  struct Trailer;

  // Flash is written by double words, each with its error correction: once only.
  static constexpr std::size_t kWriteUnit = 8;

  std::span<const std::byte> slot(std::size_t number) const;
  std::size_t slot_offset(std::size_t number) const { return first_ + number * layout_.slot_size_bytes; }
  std::size_t max_item_size() const { return layout_.slot_size_bytes - kTrailerSize; }
  bool occupied(std::size_t number) const { return (occupied_ >> number & 1) != 0; }
  bool read(std::size_t number, Trailer& trailer) const;
  void take(std::size_t number, const Trailer& trailer);
  bool choose_slot();
  void erase_next();
  void write(std::size_t offset, std::span<const std::byte> bytes);
  void write_page(std::size_t size);
  void write_trailer();
  void on_done();

  hal::StoragePort& storage_;
  const Layout layout_;
  std::size_t first_;           // offset of the first slot
  std::uint64_t occupied_ = 0;  // bit i: slot i holds the valid version of an item
  std::uint32_t sequence_ = 0;  // the highest
  std::size_t slot_ = 0;        // written last, or being written
  State state_ = State::kIdle;
  bool operating_ = false;  // the flash, for us
  std::uint16_t kind_ = 0;
  std::uint16_t number_ = 0;
  std::uint32_t crc_ = 0;
  std::size_t done_ = 0;  // bytes of the slot that are erased, or written
  std::size_t size_ = 0;  // bytes appended
  std::size_t fill_ = 0;  // those of them in the page
  std::array<std::byte, hal::StoragePort::kMaxWriteSize> page_;
};

}  // namespace koboshi::canopen
