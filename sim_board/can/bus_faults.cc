#include "sim_board/can/bus_faults.h"

namespace koboshi::sim_board {

using Effect = FrameFault::Effect;

WireEffect BusFaults::on_transmission(const hal::CanFrame& frame, NodeHandle sender, std::uint64_t start_us) {
  WireEffect effect = WireEffect::kNone;
  const auto doubled = doubled_.find(sender);
  const bool repeated = doubled != doubled_.end() && doubled->second == frame;
  for (Rule& rule : rules_) {
    if (rule.fault.effect == Effect::kCorrupted && hits(rule, frame, sender, start_us))
      return WireEffect::kDestroyed;
    if (rule.fault.effect == Effect::kDoubled && !repeated && hits(rule, frame, sender, start_us))
      effect = WireEffect::kDoubled;
  }
  if (effect == WireEffect::kDoubled) doubled_[sender] = frame;
  if (repeated) doubled_.erase(doubled);
  return effect;
}

Reception BusFaults::on_reception(const hal::CanFrame& frame, NodeHandle receiver, std::uint64_t start_us) {
  Reception reception;
  for (Rule& rule : rules_) {
    const Effect effect = rule.fault.effect;
    if (effect != Effect::kLost && effect != Effect::kDelayed) continue;
    if (!hits(rule, frame, receiver, start_us)) continue;
    if (effect == Effect::kLost) reception.lost = true;
    reception.delay_us += rule.fault.delay_us;
  }
  return reception;
}

bool BusFaults::hits(Rule& rule, const hal::CanFrame& frame, NodeHandle node, std::uint64_t start_us) {
  const FrameFault& fault = rule.fault;
  if (start_us < fault.from_us || start_us >= fault.until_us) return false;
  if (frame.identifier < fault.first_identifier || frame.identifier > fault.last_identifier) return false;
  if (fault.node && *fault.node != node) return false;
  if (rule.judged_us == start_us) return rule.hit;
  rule.judged_us = start_us;
  rule.hit = rule.hits < fault.count && (fault.share >= 1.0 || random_.uniform() < fault.share);
  if (rule.hit) ++rule.hits;
  return rule.hit;
}

}  // namespace koboshi::sim_board
