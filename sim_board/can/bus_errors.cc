// Errors on the bus: error counts, collisions, nodes that leave and return.

#include <algorithm>
#include <utility>

#include "sim_board/can/bus.h"
#include "sim_board/can/frame_bits.h"

namespace koboshi::sim_board {
namespace {

constexpr int kSuspendBits = 8;
constexpr int kDominantBits = 8;
constexpr int kRecoveryBits = 128 * kRecessiveEndBits;

// For frames with the same identifier: returns whether the first is dominant in the first bit that differs.
bool stronger(const hal::CanFrame& first, const hal::CanFrame& second) {
  return std::pair(first.size, first.data) < std::pair(second.size, second.data);
}

}  // namespace

void Bus::power_off(NodeHandle node) {
  Node& off = nodes_[index(node)];
  if (off.recovered_us != kNever) --recovering_;
  off.recovered_us = kNever;
  off.powered = false;
  for (TransmitQueue& queue : off.queues) queue.clear();
  off.errors.reset();
  off.hold_until_us = 0;
  leave(index(node));
  const auto sends = [&](std::size_t sender) { return node_of(sender) == index(node); };
  if (wire_.has_value() && std::erase_if(senders_, sends) > 0 && senders_.empty()) {
    wire_->outcome = Outcome::kDestroyed;
    wire_->end_us = now_us_ + duration_us(kErrorFrameBits);
  }
}

void Bus::power_on(NodeHandle node) {
  Node& on = nodes_[index(node)];
  if (on.powered) return;
  on.powered = true;
  on.online_since_us = now_us_;
  ++online_;
}

void Bus::leave(std::size_t node) {
  if (nodes_[node].online_since_us != kNever) --online_;
  nodes_[node].online_since_us = kNever;
  refresh_heads(node);
}

void Bus::recover(NodeHandle node) {
  Node& off = nodes_[index(node)];
  if (!off.errors.bus_off() || off.recovered_us != kNever) return;
  off.recovered_us = std::max(now_us_, idle_from_us_) + duration_us(kRecoveryBits);
  ++recovering_;
}

void Bus::set_dominant(bool dominant) {
  if (dominant == dominant_since_us_.has_value()) return;
  if (dominant) {
    ++usage_.error_frames;
    if (wire_.has_value()) {
      usage_.busy_us += now_us_ - wire_->start_us;
    } else {
      senders_.clear();
      if (idle_from_us_ > now_us_) usage_.busy_us -= idle_from_us_ - now_us_;  // ended early
    }
    wire_.reset();
    dominant_since_us_ = now_us_;
    dominant_due_us_ = now_us_ + duration_us(kDominantBits);
    return;
  }
  idle_from_us_ = now_us_ + duration_us(kRecessiveEndBits);
  usage_.busy_us += idle_from_us_ - *dominant_since_us_;
  for (Node& node : nodes_) {
    if (node.recovered_us == kNever) continue;
    node.recovered_us =
        now_us_ + std::min(duration_us(kRecoveryBits), node.recovered_us - *dominant_since_us_);
  }
  dominant_since_us_.reset();
  dominant_due_us_ = kNever;
}

void Bus::count_dominant_bits() {
  receive_errors_ = true;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    Node& node = nodes_[i];
    if (node.online_since_us == kNever) continue;
    node.errors.on_dominant_bits(is_sender(i));
    if (node.errors.bus_off()) leave(i);
  }
  dominant_due_us_ += duration_us(kDominantBits);
  // All counters are final: the sender is bus-off, and the others count no further.
  if (dominant_due_us_ > *dominant_since_us_ + 33 * duration_us(kDominantBits)) dominant_due_us_ = kNever;
}

void Bus::complete_recoveries(std::uint64_t until_us) {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    Node& node = nodes_[i];
    if (node.recovered_us > until_us) continue;
    node.errors.reset();
    node.online_since_us = node.hold_until_us = std::exchange(node.recovered_us, kNever);
    ++online_;
    --recovering_;
    refresh_heads(i);
  }
}

// Resolves a collision of frames with the same identifier. Returns the number of bits after which an error
// flag destroys the frame, or zero if the strongest frame survives; then only its senders remain, with the
// first of them at the front.
int Bus::settle_collision() {
  const auto frame_of = [this](std::size_t sender) -> const hal::CanFrame& {
    return queue_of(sender).front().frame;
  };
  std::iter_swap(senders_.begin(),
                 std::min_element(senders_.begin(), senders_.end(), [&](std::size_t a, std::size_t b) {
                   return stronger(frame_of(a), frame_of(b));
                 }));
  const hal::CanFrame& strongest = frame_of(senders_.front());
  int destroyed_after_bits = 0;
  bool collided = false;
  for (const std::size_t sender : senders_) {
    if (frame_of(sender) == strongest) continue;
    collided = true;
    if (nodes_[node_of(sender)].errors.error_passive()) continue;
    const int bits = bits_to_difference(strongest, frame_of(sender));
    destroyed_after_bits = destroyed_after_bits == 0 ? bits : std::min(destroyed_after_bits, bits);
  }
  if (collided) ++usage_.collisions;
  if (!collided || destroyed_after_bits > 0) return destroyed_after_bits;
  std::erase_if(senders_, [&](std::size_t sender) {
    if (frame_of(sender) == strongest) return false;
    ErrorCounters& errors = nodes_[node_of(sender)].errors;
    errors.on_transmit_error();
    if (errors.bus_off()) leave(node_of(sender));
    return true;
  });
  return 0;
}

void Bus::count_receptions() {
  receive_errors_ = false;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (nodes_[i].online_since_us != kNever && !is_sender(i)) nodes_[i].errors.on_received();
    receive_errors_ = receive_errors_ || nodes_[i].errors.receive() > 0;
  }
}

void Bus::count_errors(Outcome outcome) {
  ++usage_.error_frames;
  for (const std::size_t sender : senders_) {
    Node& node = nodes_[node_of(sender)];
    if (outcome == Outcome::kUnacknowledged) {
      node.errors.on_missing_acknowledge();
    } else {
      node.errors.on_transmit_error();
    }
    suspend_if_passive(node);
    if (node.errors.bus_off()) leave(node_of(sender));
    refresh_heads(node_of(sender));
  }
  if (outcome != Outcome::kDestroyed) return;
  receive_errors_ = true;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (nodes_[i].online_since_us != kNever && !is_sender(i)) nodes_[i].errors.on_receive_error();
  }
}

void Bus::suspend_if_passive(Node& node) {
  if (node.errors.error_passive()) node.hold_until_us = idle_from_us_ + duration_us(kSuspendBits);
}

}  // namespace koboshi::sim_board
