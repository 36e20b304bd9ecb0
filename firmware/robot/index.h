#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

namespace koboshi::robot {

// The place of a joint in its model, 0..kMaxJoints - 1, and so in every array by joint. Converts implicitly
// to an array index, but only explicitly from an integer. One byte, no overhead.
class JointIndex {
 public:
  constexpr JointIndex() noexcept = default;
  template <std::integral Integer>
  explicit constexpr JointIndex(Integer place) noexcept : place_(static_cast<std::uint8_t>(place)) {}

  // NOLINTNEXTLINE(google-explicit-constructor): array index
  constexpr operator std::size_t() const noexcept { return place_; }

 private:
  std::uint8_t place_ = 0;
};

// A link of the robot: the trunk, or the one that a joint carries.
class LinkIndex {
 public:
  // The trunk.
  constexpr LinkIndex() noexcept = default;
  // The link that this joint carries.
  explicit constexpr LinkIndex(JointIndex joint) noexcept
      : raw_(static_cast<std::int8_t>(static_cast<std::size_t>(joint))) {}
  // As an image has it: the joint's place, -1 for the trunk. Any other value is kept, for the model's check.
  [[nodiscard]] static constexpr LinkIndex from_raw(std::int8_t raw) noexcept {
    LinkIndex link;
    link.raw_ = raw;
    return link;
  }

  [[nodiscard]] constexpr std::int8_t raw() const noexcept { return raw_; }
  [[nodiscard]] constexpr bool is_trunk() const noexcept { return raw_ == kTrunk; }
  // The joint that carries the link. Not for the trunk.
  [[nodiscard]] constexpr JointIndex joint() const noexcept { return JointIndex(raw_); }

  friend constexpr bool operator==(LinkIndex, LinkIndex) noexcept = default;

 private:
  static constexpr std::int8_t kTrunk = -1;

  std::int8_t raw_ = kTrunk;
};

static_assert(sizeof(JointIndex) == 1 && sizeof(LinkIndex) == 1);

}  // namespace koboshi::robot
