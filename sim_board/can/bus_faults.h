#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "sim_board/can/disturbance.h"
#include "sim_board/random/random_stream.h"

namespace koboshi::sim {

// A fault that some frames suffer for some time.
struct FrameFault {
  enum class Effect : std::uint8_t { kLost, kCorrupted, kDelayed, kDoubled };
  static constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

  Effect effect = Effect::kLost;
  std::uint16_t first_identifier = 0;  // of the frames concerned, both bounds included
  std::uint16_t last_identifier = 0x7FF;
  std::optional<NodeHandle> node{};  // who receives, of lost and delayed ones; else who sends; none: anybody
  double share = 1.0;                // of these frames, by chance
  std::uint64_t count = kUnlimited;  // of those by chance, the first ones
  std::uint64_t delay_us = 0;        // of kDelayed
  std::uint64_t from_us = 0;         // frames that start from then on
  std::uint64_t until_us = kUnlimited;  // and before then
};

// Faults of frames, several at a time, with random numbers of their own: the dice are cast once for each
// transmission and fault, in the order of the bus.
class BusFaults final : public BusDisturbance {
 public:
  explicit BusFaults(std::uint64_t seed) : random_(seed, "bus") {}

  void add(const FrameFault& fault) { rules_.push_back({.fault = fault}); }
  bool empty() const { return rules_.empty(); }

  // What is corrupted is not doubled. The repetition of a doubled frame is neither counted nor doubled again.
  WireEffect on_transmission(const hal::CanFrame& frame, NodeHandle sender, std::uint64_t start_us) override;
  // Delays add up.
  Reception on_reception(const hal::CanFrame& frame, NodeHandle receiver, std::uint64_t start_us) override;

 private:
  struct Rule {
    FrameFault fault;
    std::uint64_t hits = 0;
    std::optional<std::uint64_t> judged_us{};  // start of the transmission that was judged last,
    bool hit = false;                          // and how
  };
  bool hits(Rule& rule, const hal::CanFrame& frame, NodeHandle node, std::uint64_t start_us);

  RandomStream random_;
  std::vector<Rule> rules_;
  std::map<NodeHandle, hal::CanFrame> doubled_;  // by sender, what it has to repeat
};

}  // namespace koboshi::sim
