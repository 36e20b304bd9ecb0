#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/fixed/contract.h"
#include "firmware/storage/item.h"
#include "hal/port/storage.h"

namespace koboshi::storage {

// Items that a device writes itself, in a log at the end of its storage
// (docs/decision/0018-motions-in-a-log.md).
//
//   log: records in a ring of sectors. New records go to its head, which moves on in rotation, so that all
//   sectors wear alike. A sector is erased when the head enters it. Records span sectors, but not the end of
//   the ring: an item is contiguous in memory.
//
//   record: a header, then the item, padded to whole write units. Header: kind u8, number u8, size u16 of the
//   item in bytes (0xFFFF: the item was erased), sequence u32, CRC-32 u32 of the item, CRC-32 u32 of the
//   header before it; little-endian. Of two records of the same item, the higher sequence counts. The header
//   of a new item is written last, and makes it valid.
//
// Compaction frees space: it copies the oldest live record to the head, under the next sequence, one flash
// operation at a time; the space before the next live record is then free. `begin` drives it, and `process`
// continues it until an item as large as the largest can begin at once.
//
// Reserve. Let C be the size of the ring, S that of a sector, L all live records, R the largest, n a new one.
//
//   1. The head enters a sector only when no live record overlaps it. While it copies a record, at most
//      R - 8 bytes of the copy and S - 8 bytes of the sector of the source are neither free nor gained: R + S
//      free bytes between the head and the next live record let every copy end.
//   2. A power failure costs the rest of the head's sector, less than S, if the sector contains a new item.
//   If
//      it contains copies only, it costs nothing, however often power fails: no source is overwritten before
//      the head leaves the sector, so `recover` takes the sources back and fills the same sector again. A
//      copy that began in the sector before continues there. So a further S lasts until the next new item.
//   3. At the end of the ring, less than R bytes remain unused in each rotation.
//
// A new item therefore fits if L + n + 2 (R + S) <= C, where R includes n; compaction can then always
// provide its place, and an item can always be erased (16 bytes more).
//
// One item is written at a time, by one writer: `begin`, until it returns kOk, then `append`, `flush`,
// `written` and `commit` as needed, and `release`. The functions in between require that `begin` has returned
// kOk and `release` has not been called since. No function waits for the flash: it returns kBusy, has done
// nothing, and is to be called again.
class ItemStore {  // Large: the stages of a write, and of a copy meanwhile
 public:
  static constexpr std::size_t kHeaderSize = 16;
  static constexpr std::size_t kMaxItemSize_bytes = 12 * 1024;
  // The most bytes of one `append`: a page, less what may wait in it for the rest of its write unit.
  static constexpr std::size_t kMaxAppendSize =
      hal::StoragePort::kMaxWriteSize - (hal::StoragePort::kWriteUnit_bytes - 1);

  // Reads the log in the last `size_bytes` of the storage: a whole number of sectors. Records that are not
  // whole are ignored. A smaller storage has no log: it stores nothing. `storage` must outlive the store.
  ItemStore(hal::StoragePort& storage, std::size_t size_bytes);

  // The bytes of an item, in place; empty when there is none. They stay until the item is replaced or moved;
  // both need calls of `process` or of a writer, so that they hold at least for the present millisecond.
  std::span<const std::byte> find(ItemKind kind, std::uint16_t number) const;

  // A mark that a reader leaves on an item, for example once it has validated its bytes. It lasts while
  // `find` returns the same bytes, wherever they move: a replacement, an erasure and a restart remove it.
  void mark(ItemKind kind, std::uint16_t number);
  [[nodiscard]] bool marked(ItemKind kind, std::uint16_t number) const;

  // Keeps the bytes of an item that `find` has returned, even if it is replaced or erased, until the holder
  // pins another or unpins it. Bytes outside the log need no pin. While pins block the space that a new item
  // needs, `begin` returns kInUse.
  void pin(Holder holder, std::span<const std::byte> item);
  void unpin(Holder holder);

  // Begins an item of at most `size_bytes`: kBusy while its place is prepared, kInUse while another item is
  // being written or pins block its place, kFull if it does not fit, kTooLong beyond kMaxItemSize_bytes.
  // kFailed here and below when the flash fails.
  Status begin(ItemKind kind, std::uint16_t number, std::size_t size_bytes = kMaxItemSize_bytes);
  // Appends all of these bytes, at most kMaxAppendSize, or none: kBusy while there is no room for them,
  // kTooLong beyond the size that `begin` was given.
  Status append(std::span<const std::byte> bytes);
  // Ends the appending. Once it returns kOk, all bytes are in flash and `written` shows them.
  Status flush();
  std::span<const std::byte> written() const {
    KOBOSHI_ASSERT(begun_);
    return bytes_at(record_ + kHeaderSize, appended_);
  }
  // Once it returns kOk, `find` finds the new version. To be repeated until then.
  Status commit();
  // Ends what `begin` has begun; without `commit`, nothing has changed. No effect if nothing has begun.
  void release();

  // Erases an item. To be repeated until it returns kOk, from when `find` no longer finds it; kInUse while an
  // item is being written or pins block the space.
  Status erase(ItemKind kind, std::uint16_t number);

  // The space left for further items that are not larger than the largest one, each with its header.
  std::size_t free_bytes() const;

  // To be called once a millisecond. Starts at most one operation of the flash.
  void process() {
    const bool copies = state_ == State::kCopying && !stalled_;
    if (operating_ || tidies_ || copies || state_ == State::kOpen) advance();
  }

 private:
  enum class State : std::uint8_t {
    kIdle,
    kOpen,     // an item is being appended
    kSealing,  // its header is being written
    kSealed,
    kErasing,  // the header that erases an item is being written
    kCopying,
    kFailed,
  };
  struct Header;

  static constexpr std::size_t kWriteUnit = hal::StoragePort::kWriteUnit_bytes;
  // Items by number: motions, then the parameters, the node id and the policy.
  static constexpr std::size_t kKeys = kMaxMotions + 3;
  static constexpr std::size_t kNoKey = kKeys;
  static constexpr std::uint16_t kNone = 0xFFFF;
  using Index = std::array<std::uint16_t, kKeys>;  // start of each item's record in write units, or kNone

  static std::size_t key_of(std::uint16_t kind, std::uint16_t number);
  static constexpr std::size_t offset_of(std::uint16_t place) { return std::size_t{place} * kWriteUnit; }
  static constexpr std::uint16_t place_of(std::size_t offset) {
    return static_cast<std::uint16_t>(offset / kWriteUnit);
  }

  // Reading the log. All offsets are in bytes from its start.
  std::span<const std::byte> bytes_at(std::size_t offset, std::size_t size) const {
    return storage_.contents().subspan(first_ + offset, size);
  }
  bool read(std::size_t offset, Header& header) const;
  std::size_t record_size_at(std::size_t offset) const;
  bool overlaps(std::uint16_t place, std::size_t sector) const;
  std::uint16_t size_field_at(std::size_t offset) const;
  std::uint32_t sequence_at(std::uint16_t place) const;
  bool are_equal(std::uint16_t place, std::uint16_t other) const;

  // Recovery at boot.
  void scan(Index& older);
  void recover();
  bool contains_copies_only(std::size_t sector, const Index& older) const;
  void resume_copy(std::size_t start, std::size_t end);
  std::uint16_t newest() const;

  // Space.
  struct Space {
    std::size_t free = 0;        // from the head to the next live or pinned record
    std::size_t oldest = 0;      // where this record starts; `size_` if there is none
    std::size_t oldest_key = 0;  // kNoKey: it is not live, only pinned
    std::size_t last_end = 0;    // where the last record before the end of the ring ends
    std::size_t largest = 0;     // size of the largest live record
  };
  Space space() const;
  bool fits(std::size_t size, std::size_t largest) const;
  bool has_room(std::size_t size, const Space& space) const;
  bool sector_is_free(std::size_t sector) const;
  std::size_t sector_after(std::size_t offset) const;
  void set_head(std::size_t offset);

  // Operations.
  Status prepare(std::size_t size, std::size_t spare);
  Status start_copy(const Space& space);
  void advance_copy();
  std::array<std::byte, kHeaderSize> copied_header() const;
  void tidy();
  bool erase_next();
  void write(std::size_t offset, std::span<const std::byte> bytes);
  void write_page(std::size_t size);
  void write_header(std::uint16_t size);
  void advance();
  void on_done();
  void on_header_written();
  void on_failed();
  void replace(std::size_t key, std::uint16_t place);

  hal::StoragePort& storage_;
  const std::size_t sector_size_;
  const std::size_t size_;   // of the log; 0: there is none
  const std::size_t first_;  // offset of the log in the storage
  Index index_;
  std::array<std::uint16_t, kHolders> pins_;
  std::array<std::uint32_t, (kKeys + 31) / 32> marks_{};  // bit b of element i: key 32 i + b
  std::size_t live_bytes_ = 0;                            // of all live records
  std::uint32_t sequence_ = 0;                            // the highest
  std::size_t head_ = 0;       // where the next record starts, if it fits before the end of the ring
  std::size_t erased_ = 0;     // the flash is erased from the head up to here
  std::size_t operation_ = 0;  // where the range of the last operation starts
  std::size_t operation_end_ = 0;
  State state_ = State::kIdle;
  bool begun_ = false;      // between `begin` and `release`
  bool operating_ = false;  // a flash operation of this store is running
  bool erases_ = false;     // it is an erasure
  bool failed_ = false;     // of the operations that prepare a place; reported once
  bool stalled_ = false;    // a copy waits for a pin
  bool tidies_ = true;      // compaction may be due
  // State of the record that is being written:
  std::size_t key_ = kNoKey;
  std::size_t record_ = 0;      // its start
  std::size_t source_ = 0;      // of a copy
  std::size_t done_ = 0;        // bytes written, or being written: of the item; of a copy: of the record
  std::size_t announced_ = 0;   // the highest size
  std::size_t appended_ = 0;    // bytes appended
  std::size_t page_fill_ = 0;   // bytes appended that wait in the page
  std::uint32_t crc_ = 0;       // of the bytes appended
  std::uint32_t read_crc_ = 0;  // of the bytes read back
  std::array<std::byte, hal::StoragePort::kMaxWriteSize> page_;
};

// The log of the robot's own items: parameters, and motions that replace those of the factory's catalogue.
// 200 motions of 12 poses of all 20 joints fit, with sectors of up to 2 KiB.
inline constexpr std::size_t kRobotLogSize_bytes = 128 * 1024;

}  // namespace koboshi::storage
