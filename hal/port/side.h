#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace koboshi::hal {

// The side of a foot, leg or arm, from the robot's point of view.
enum class Side : std::uint8_t { kLeft = 0, kRight = 1 };

[[nodiscard]] constexpr Side other(Side side) { return side == Side::kLeft ? Side::kRight : Side::kLeft; }

// One T per side, the left one first: an array with a Side as index.
template <typename T>
struct BySide : std::array<T, 2> {
  using std::array<T, 2>::operator[];
  constexpr T& operator[](Side side) noexcept { return (*this)[static_cast<std::size_t>(side)]; }
  constexpr const T& operator[](Side side) const noexcept { return (*this)[static_cast<std::size_t>(side)]; }
};

}  // namespace koboshi::hal
