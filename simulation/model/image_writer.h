#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware/fixed/units.h"
#include "firmware/robot/geometry.h"

namespace koboshi::simulation {

// Writes images in the format of firmware/storage/image.h: a header followed by little-endian fields.
class ImageWriter {
 public:
  void u8(std::uint8_t value) { put(value, 1); }
  void i8(std::int8_t value) { put(static_cast<std::uint8_t>(value), 1); }
  void u16(std::uint16_t value) { put(value, 2); }
  void u32(std::uint32_t value) { put(value, 4); }

  template <fixed::AnyQuantity Q>
  void quantity(Q value) {
    put(static_cast<std::uint32_t>(value.raw()), 4);
  }
  template <fixed::AnyQuantity Q>
  void vector(const robot::Vector<Q>& value) {
    quantity(value.x);
    quantity(value.y);
    quantity(value.z);
  }

  // Returns the image with its header, including size and CRC-32.
  [[nodiscard]] std::vector<std::byte> finish(std::uint32_t magic, std::uint16_t version) const;

 private:
  void put(std::uint32_t value, int size) {
    for (int i = 0; i < size; ++i) body_.push_back(static_cast<std::byte>(value >> (8 * i) & 0xFFu));
  }

  std::vector<std::byte> body_;
};

}  // namespace koboshi::simulation
