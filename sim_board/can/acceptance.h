#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

namespace koboshi::sim {

inline constexpr std::size_t kIdentifiers = 2048;

// The 11-bit identifiers that a CAN controller passes to its node.
class AcceptanceFilter {
 public:
  static AcceptanceFilter all() {
    AcceptanceFilter filter;
    filter.accepted_.set();
    return filter;
  }
  AcceptanceFilter() = default;  // rejects all frames
  AcceptanceFilter(std::initializer_list<std::uint16_t> identifiers) {
    for (const std::uint16_t identifier : identifiers) accept(identifier);
  }

  void accept(std::uint16_t identifier) { accepted_.set(identifier); }
  void accept_range(std::uint16_t first, std::uint16_t last) {
    for (std::size_t identifier = first; identifier <= last; ++identifier) accepted_.set(identifier);
  }
  bool accepts(std::uint16_t identifier) const { return accepted_.test(identifier); }

 private:
  std::bitset<kIdentifiers> accepted_;
};

// Receivers of each identifier, in the order of their indices. A frame costs time only for the nodes that
// accept it.
class ReceiverTable {
 public:
  ReceiverTable() { rebuild({}); }
  void rebuild(std::span<const AcceptanceFilter> filters) {
    receivers_.clear();
    for (std::uint16_t identifier = 0; identifier < kIdentifiers; ++identifier) {
      begin_[identifier] = receivers_.size();
      for (std::size_t node = 0; node < filters.size(); ++node) {
        if (filters[node].accepts(identifier)) receivers_.push_back(static_cast<std::uint16_t>(node));
      }
    }
    begin_[kIdentifiers] = receivers_.size();
  }
  std::span<const std::uint16_t> of(std::uint16_t identifier) const {
    const std::size_t begin = begin_[identifier];
    return {receivers_.data() + begin, begin_[identifier + std::size_t{1}] - begin};
  }

 private:
  std::array<std::size_t, kIdentifiers + 1> begin_{};
  std::vector<std::uint16_t> receivers_;
};

}  // namespace koboshi::sim
