#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

namespace koboshi::sim_board {

inline constexpr std::size_t kIdentifiers = 2048;
inline constexpr std::size_t kWordBits = 64;

// Calls visit(first + i) for each bit i of a word that is set, in ascending order.
template <typename Visit>
void for_each_bit(std::uint64_t word, std::size_t first, Visit visit) {
  for (; word != 0; word &= word - 1) visit(first + static_cast<std::size_t>(std::countr_zero(word)));
}

// The 11-bit identifiers that a CAN controller passes to its node.
class AcceptanceFilter {
 public:
  static AcceptanceFilter all() {
    AcceptanceFilter filter;
    filter.words_.fill(~std::uint64_t{0});
    return filter;
  }
  AcceptanceFilter() = default;  // rejects all frames
  AcceptanceFilter(std::initializer_list<std::uint16_t> identifiers) {
    for (const std::uint16_t identifier : identifiers) accept(identifier);
  }

  void accept(std::uint16_t identifier) {
    words_[identifier / kWordBits] |= std::uint64_t{1} << identifier % kWordBits;
  }
  void accept_range(std::uint16_t first, std::uint16_t last) {
    for (std::size_t identifier = first; identifier <= last; ++identifier)
      accept(static_cast<std::uint16_t>(identifier));
  }
  bool accepts(std::uint16_t identifier) const {
    return (words_[identifier / kWordBits] >> identifier % kWordBits & 1u) != 0;
  }
  // Calls visit(identifier) for each identifier that only one of two filters accepts.
  template <typename Visit>
  static void for_each_difference(const AcceptanceFilter& a, const AcceptanceFilter& b, Visit visit) {
    for (std::size_t i = 0; i < a.words_.size(); ++i)
      for_each_bit(a.words_[i] ^ b.words_[i], kWordBits * i, visit);
  }

 private:
  std::array<std::uint64_t, kIdentifiers / kWordBits> words_{};
};

// The nodes that accept each identifier. A frame costs time only for these nodes; a change of a filter costs
// time only for the identifiers that it changes, and allocates nothing.
class ReceiverTable {
 public:
  // Adds a node with the next index, from 0.
  void add(const AcceptanceFilter& filter) {
    if (filters_.size() % kWordBits == 0) nodes_.emplace_back();
    filters_.emplace_back();
    set(filters_.size() - 1, filter);
  }
  void set(std::size_t node, const AcceptanceFilter& filter) {
    AcceptanceFilter::for_each_difference(filters_[node], filter, [&](std::size_t identifier) {
      nodes_[node / kWordBits][identifier] ^= std::uint64_t{1} << node % kWordBits;
    });
    filters_[node] = filter;
  }
  bool accepts(std::size_t node, std::uint16_t identifier) const {
    return filters_[node].accepts(identifier);
  }
  // Calls visit(node) for each node that accepts the identifier, in the order of the indices. `visit` may
  // change filters.
  template <typename Visit>
  void for_each(std::uint16_t identifier, Visit visit) const {
    for (std::size_t i = 0; i < nodes_.size(); ++i) for_each_bit(nodes_[i][identifier], kWordBits * i, visit);
  }

 private:
  std::vector<AcceptanceFilter> filters_;  // by node
  // A bit per node: bit n of element i belongs to node 64 i + n.
  std::vector<std::array<std::uint64_t, kIdentifiers>> nodes_;
};

}  // namespace koboshi::sim_board
