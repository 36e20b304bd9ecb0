#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace koboshi::canopen {

// Maps an identifier or node id to a slot of an array: in O(log n), in O(1) if keys are looked up in
// ascending order. The owner provides the memory.
class SlotMap {
 public:
  struct Item {
    std::uint16_t key = 0;
    std::uint8_t slot = 0;
  };
  static constexpr std::size_t kNone = ~std::size_t{0};

  explicit SlotMap(std::span<Item> items) : items_(items) {}

  void clear() { size_ = 0; }
  // Ignored beyond the number of items. Of equal keys the first one inserted is found.
  void insert(std::uint16_t key, std::uint8_t slot) {
    if (size_ == items_.size()) return;
    std::size_t place = size_++;
    for (; place > 0 && items_[place - 1].key > key; --place) items_[place] = items_[place - 1];
    items_[place] = {key, slot};
  }
  // The slot of a key, or kNone. Tries the key after the last one found first: arbitration lets the frames of
  // a cycle arrive in the order of their identifiers.
  std::size_t find(std::uint16_t key) const {
    if (next_ < size_ && items_[next_].key == key && items_[next_ - 1].key != key)
      return items_[next_++].slot;
    return search(key);
  }

 private:
  std::size_t search(std::uint16_t key) const {
    const std::span<const Item> used = items_.first(size_);
    const auto item = std::ranges::lower_bound(used, key, {}, &Item::key);
    if (item == used.end() || item->key != key) return kNone;
    next_ = static_cast<std::size_t>(item - used.begin()) + 1;
    return item->slot;
  }

  std::span<Item> items_;
  std::size_t size_ = 0;
  mutable std::size_t next_ = 1;  // a guess, never 0: behind the item found last
};

}  // namespace koboshi::canopen
