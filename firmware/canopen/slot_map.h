#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace koboshi::canopen {

// Which slot of an array an identifier or node id belongs to, for reception in O(log n). Memory is the
// owner's.
class SlotMap {
 public:
  struct Item {
    std::uint16_t key = 0;
    std::uint8_t slot = 0;
  };
  static constexpr std::size_t kNone = ~std::size_t{0};

  explicit SlotMap(std::span<Item> items) : items_(items) {}

  void clear() { size_ = 0; }
  // At most as many as there are items; of equal keys the first stays in front.
  void insert(std::uint16_t key, std::uint8_t slot);
  // kNone when there is no such key.
  std::size_t find(std::uint16_t key) const;

 private:
  std::span<Item> items_;
  std::size_t size_ = 0;
};

}  // namespace koboshi::canopen
