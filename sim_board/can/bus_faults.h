#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "sim_board/can/disturbance.h"
#include "sim_board/random/random_stream.h"

namespace koboshi::sim_board {

// A fault that affects some frames during an interval.
struct FrameFault {
  enum class Effect : std::uint8_t { kLost, kCorrupted, kDelayed, kDoubled };
  static constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

  Effect effect = Effect::kLost;
  std::uint16_t first_identifier = 0;  // range of affected identifiers, inclusive
  std::uint16_t last_identifier = 0x7FF;
  std::optional<NodeHandle> node{};  // receiver of lost and delayed frames, otherwise the sender; empty: any
                                     // node
  double share = 1.0;                // probability per frame
  std::uint64_t count = kUnlimited;  // maximum number of affected frames
  std::uint64_t delay_us = 0;        // for kDelayed
  std::uint64_t from_us = 0;         // start of the interval, compared with the start of a frame
  std::uint64_t until_us = kUnlimited;  // end of the interval, exclusive
};

// Several simultaneous frame faults with a random stream of their own. The number of draws is one per
// transmission and fault, in bus order.
class BusFaults final : public BusDisturbance {
 public:
  explicit BusFaults(std::uint64_t seed) : random_(seed, "bus") {}

  void add(const FrameFault& fault) { rules_.push_back({.fault = fault}); }
  bool empty() const { return rules_.empty(); }

  // A destroyed frame is not doubled. The repetition of a doubled frame is neither counted nor doubled again.
  WireEffect on_transmission(const hal::CanFrame& frame, NodeHandle sender, std::uint64_t start_us) override;
  // Delays of several faults add up.
  Reception on_reception(const hal::CanFrame& frame, NodeHandle receiver, std::uint64_t start_us) override;

 private:
  struct Rule {
    FrameFault fault;
    std::uint64_t hits = 0;
    std::optional<std::uint64_t> judged_us{};  // start of the last judged transmission
    bool hit = false;                          // and its result
  };
  bool hits(Rule& rule, const hal::CanFrame& frame, NodeHandle node, std::uint64_t start_us);

  RandomStream random_;
  std::vector<Rule> rules_;
  std::map<NodeHandle, hal::CanFrame> doubled_;  // frame to repeat, by sender
};

}  // namespace koboshi::sim_board
