#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/storage/item_store.h"

namespace koboshi::storage {

// The value of one object of a device, as it is stored: a record of index u16, sub-index u8, size u8 and
// value u32, little-endian.
struct ParameterRecord {
  static constexpr std::size_t kSize_bytes = 8;

  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t size_bytes = 0;  // of the value: 1..4
  std::uint32_t value = 0;

  friend bool operator==(const ParameterRecord&, const ParameterRecord&) = default;
};

// Reads the record at `offset` of an item. False past the last whole record.
[[nodiscard]] bool read_record(std::span<const std::byte> item, std::size_t offset, ParameterRecord& record);

// The device whose parameters are stored.
class ParameterOwner {
 public:
  // The present value of the next parameter from `place` on, which is 0 at first and is moved on behind it,
  // in the order in which they are to be restored. False past the last.
  virtual bool next_parameter(std::size_t& place, ParameterRecord& record) const = 0;
  // Takes a stored value over; the owner ignores those that it does not know or that its limits refuse.
  virtual void restore(const ParameterRecord& record) = 0;

 protected:
  ~ParameterOwner() = default;
};

// Indices from `first` to `last`, both included: the objects that a change of the store is about.
struct IndexRange {
  std::uint16_t first = 0;
  std::uint16_t last = 0xFFFF;

  constexpr bool contains(std::uint16_t index) const { return first <= index && index <= last; }

  friend bool operator==(const IndexRange&, const IndexRange&) = default;
};

// The parameters of a device in storage: one item of records in the owner's order. A firmware with other
// parameters finds those that it knows. Since all of them lie in one item, a power failure leaves all the old
// values or all the new ones.
class ParameterStore {
 public:
  // Both must outlive the store. The item has the kind kParameters and the number 0.
  ParameterStore(ItemStore& items, ParameterOwner& owner) : items_(items), owner_(owner) {}

  // Make storage hold the present values of the objects in the range, or (`clear`) no values of them, so that
  // those of the factory count after the next reset. Other objects stay as they are stored. kBusy until it is
  // done, also while another range is stored or cleared; then kOk, or why it failed. A failure is returned
  // once, to the next call for the same range. Nothing is written that is stored already; with `may_write`
  // false, kNotAllowed if something would have to be written.
  Status store(IndexRange range, bool may_write = true) { return change({range, true}, may_write); }
  Status clear(IndexRange range, bool may_write = true) { return change({range, false}, may_write); }
  // Gives the owner the stored values in the range. Abandons a change that is under way, as a power failure
  // would: it would mix values from before and after.
  void load(IndexRange range);
  // To be called once a millisecond.
  void process() {
    if (busy_) advance();
  }

 private:
  struct Change {
    IndexRange range;
    bool keeps = true;  // the present values, instead of none

    friend bool operator==(const Change&, const Change&) = default;
  };
  // How far a walk through the records of the wanted item has come.
  struct Cursor {
    std::size_t stored_bytes = 0;  // of the item in storage
    std::size_t present = 0;       // place in the owner's parameters
  };

  std::span<const std::byte> stored() const { return items_.find(ItemKind::kParameters, 0); }
  Status change(Change wanted, bool may_write);
  bool next(Change wanted, Cursor& cursor, ParameterRecord& record) const;
  bool is_stored(Change wanted) const;
  std::size_t size_bytes(Change wanted) const;
  void advance();
  Status write_records();
  void abandon();
  void end();

  ItemStore& items_;
  ParameterOwner& owner_;
  bool busy_ = false;
  bool begun_ = false;  // the item
  Change wanted_;
  std::size_t size_bytes_ = 0;  // of the wanted item
  Cursor cursor_;
  Change failed_;                 // the last change that failed
  Status failure_ = Status::kOk;  // its result, until it is returned
};

}  // namespace koboshi::storage
