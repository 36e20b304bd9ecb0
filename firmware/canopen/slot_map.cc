#include "firmware/canopen/slot_map.h"

#include <algorithm>

namespace koboshi::canopen {

void SlotMap::insert(std::uint16_t key, std::uint8_t slot) {
  if (size_ == items_.size()) return;
  std::size_t place = size_++;
  for (; place > 0 && items_[place - 1].key > key; --place) items_[place] = items_[place - 1];
  items_[place] = {key, slot};
}

std::size_t SlotMap::search(std::uint16_t key) const {
  const std::span<const Item> used = items_.first(size_);
  const auto item = std::lower_bound(used.begin(), used.end(), key,
                                     [](const Item& left, std::uint16_t right) { return left.key < right; });
  if (item == used.end() || item->key != key) return kNone;
  next_ = static_cast<std::size_t>(item - used.begin()) + 1;
  return item->slot;
}

}  // namespace koboshi::canopen
