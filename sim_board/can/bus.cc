#include "sim_board/can/bus.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "sim_board/can/frame_bits.h"

namespace koboshi::sim_board {
namespace {

std::uint32_t priority(const hal::CanFrame& frame) {
  return frame.identifier * 2u + (frame.remote ? 1u : 0u);
}

// Returns the frame as transmitted: without bytes beyond its size.
hal::CanFrame without_rest(hal::CanFrame frame) {
  const std::size_t used = frame.remote ? 0 : frame.size;
  std::fill(frame.data.begin() + static_cast<std::ptrdiff_t>(used), frame.data.end(), std::uint8_t{0});
  return frame;
}

}  // namespace

double bus_load(const BusUsage& from, const BusUsage& to) {
  if (to.time_us == from.time_us) return 0.0;
  return static_cast<double>(to.busy_us - from.busy_us) / static_cast<double>(to.time_us - from.time_us);
}

Bus::Bus(std::uint64_t bit_time_us) : bit_time_us_(bit_time_us) { assert(bit_time_us > 0); }

NodeHandle Bus::attach(BusNode& node, const AcceptanceFilter& filter, const TransmitCapacity& capacity) {
  nodes_.push_back(
      {.node = &node,
       .queues = {TransmitQueue(capacity[0]), TransmitQueue(capacity[1]), TransmitQueue(capacity[2])},
       .errors = {},
       .counters = {},
       .online_since_us = now_us_});
  heads_.resize(hal::kTransmitFifos * nodes_.size());
  waiting_.resize(heads_.size() / kWordBits + 1);
  receivers_.add(filter);
  senders_.reserve(nodes_.size());
  ++online_;
  return static_cast<NodeHandle>(nodes_.size() - 1);
}

bool Bus::queue(NodeHandle node, const hal::CanFrame& frame, std::uint64_t ready_us) {
  Node& sender = nodes_[index(node)];
  if (!sender.powered) return false;
  const hal::TransmitFifo fifo = hal::transmit_fifo(frame);
  if (!sender.queues[fifo].push({without_rest(frame), std::max(ready_us, now_us_)})) {
    ++sender.counters.overruns;
    return false;
  }
  refresh_head(hal::kTransmitFifos * index(node) + fifo);
  return true;
}

void Bus::advance_to(std::uint64_t time_us) {
  assert(time_us >= now_us_);
  for (;;) {
    const std::uint64_t until_us = std::min({time_us, next_late_us(), dominant_due_us_});
    if (dominant_due_us_ <= until_us) {
      now_us_ = dominant_due_us_;
      count_dominant_bits();
    } else if (wire_.has_value() && wire_->end_us <= until_us) {
      now_us_ = wire_->end_us;
      finish();
    } else if (wire_.has_value() || !start_next(until_us)) {
      if (next_late_us() > time_us) break;
      now_us_ = next_late_us();
      deliver_late();
    }
  }
  now_us_ = time_us;
}

BusUsage Bus::usage() const {
  BusUsage usage = usage_;
  usage.time_us = now_us_;
  if (wire_.has_value()) {
    usage.busy_us += now_us_ - wire_->start_us;
  } else if (dominant_since_us_) {
    usage.busy_us += now_us_ - *dominant_since_us_;
  } else if (idle_from_us_ > now_us_) {
    usage.busy_us -= idle_from_us_ - now_us_;  // the intermission is not over yet
  }
  return usage;
}

void Bus::refresh_head(std::size_t head) {
  const Node& sender = nodes_[node_of(head)];
  const TransmitQueue& queue = queue_of(head);
  const std::uint64_t bit = std::uint64_t{1} << head % kWordBits;
  if (queue.empty() || sender.online_since_us == kNever) {
    waiting_[head / kWordBits] &= ~bit;
  } else {
    const QueuedFrame& front = queue.front();
    heads_[head] = {std::max(front.ready_us, sender.hold_until_us), priority(front.frame)};
    waiting_[head / kWordBits] |= bit;
  }
}

void Bus::refresh_heads(std::size_t node) {
  for (std::size_t fifo = 0; fifo < hal::kTransmitFifos; ++fifo)
    refresh_head(hal::kTransmitFifos * node + fifo);
}

std::uint64_t Bus::next_start_us() const {
  std::uint64_t ready_us = kNever;
  for_each_waiting([&](std::size_t head) { ready_us = std::min(ready_us, heads_[head].ready_us); });
  return std::max(ready_us, idle_from_us_);
}

// Starts the next transmission if it begins before `until_us`.
bool Bus::start_next(std::uint64_t until_us) {
  if (dominant_since_us_) return false;
  std::uint64_t start_us = next_start_us();
  if (recovering_ > 0) {
    complete_recoveries(std::min(start_us, until_us));
    start_us = next_start_us();
  }
  if (start_us >= until_us) return false;
  gather_senders(start_us);
  wire_ = make_transmission(start_us);
  return true;
}

// Collects the frames that begin at this time. A node sends one frame at a time: of two with the same
// identifier, the one in its first FIFO.
void Bus::gather_senders(std::uint64_t start_us) {
  senders_.clear();
  std::uint32_t best = std::numeric_limits<std::uint32_t>::max();
  for_each_waiting([&](std::size_t i) {
    if (heads_[i].ready_us > start_us || heads_[i].priority > best) return;
    if (heads_[i].priority < best) senders_.clear();
    best = heads_[i].priority;
    if (senders_.empty() || node_of(senders_.back()) != node_of(i)) senders_.push_back(i);
  });
}

// Returns the bits between the end of a transmission and the earliest start of the next.
int Bus::bits_after(Outcome outcome) {
  // The receivers' overload flags begin one bit after the sender's error flag.
  constexpr int kSendersErrorBits = kErrorFlagBits + 1 + kErrorDelimiterBits;
  return outcome == Outcome::kDoubled ? kSendersErrorBits + kIntermissionBits : kIntermissionBits;
}

// Returns the outcome of a frame without a collision.
Bus::Outcome Bus::outcome_of(const hal::CanFrame& frame, std::uint64_t start_us) {
  const WireEffect effect = disturbance_ == nullptr
                                ? WireEffect::kNone
                                : disturbance_->on_transmission(
                                      frame, static_cast<NodeHandle>(node_of(senders_.front())), start_us);
  if (effect == WireEffect::kDestroyed) return Outcome::kDestroyed;
  if (online_ == senders_.size()) return Outcome::kUnacknowledged;
  return effect == WireEffect::kDoubled ? Outcome::kDoubled : Outcome::kDelivered;
}

Bus::Transmission Bus::make_transmission(std::uint64_t start_us) {
  const int destroyed_after_bits = senders_.size() > 1 ? settle_collision() : 0;
  const hal::CanFrame& frame = queue_of(senders_.front()).front().frame;
  const bool collides = destroyed_after_bits > 0;
  const Outcome outcome = collides ? Outcome::kDestroyed : outcome_of(frame, start_us);
  int bits = frame_bits(frame);
  if (collides) {
    bits = destroyed_after_bits + kErrorFrameBits;
  } else if (outcome == Outcome::kDestroyed) {
    bits = bits - kUnstuffedTailBits + kErrorFrameBits;  // detected at the end of the CRC sequence
  } else if (outcome == Outcome::kUnacknowledged) {
    // The ACK slot stays recessive; no other node adds an error flag.
    bits = bits - kAckDelimiterBits - kEndOfFrameBits + kErrorFlagBits + kErrorDelimiterBits;
  }
  if (recovering_ > 0) {
    for (Node& node : nodes_) {
      if (node.recovered_us != kNever)
        node.recovered_us += duration_us(bits + bits_after(outcome) - kRecessiveEndBits);
    }
  }
  return {frame, start_us, start_us + duration_us(bits), outcome};
}

void Bus::finish() {
  const Transmission done = *wire_;
  wire_.reset();
  idle_from_us_ = done.end_us + duration_us(bits_after(done.outcome));
  usage_.busy_us += idle_from_us_ - done.start_us;
  if (done.outcome != Outcome::kDelivered) count_errors(done.outcome);
  if (done.outcome == Outcome::kDestroyed || done.outcome == Outcome::kUnacknowledged) return;
  ++usage_.frames;
  if (done.outcome == Outcome::kDelivered) count_sent(done.start_us);
  if (receive_errors_) count_receptions();
  if (observer_ != nullptr) observer_->on_bus_frame(done.frame, done.start_us, done.end_us);
  deliver(done);
}

void Bus::deliver(const Transmission& done) {
  if (disturbance_ != nullptr) return deliver_disturbed(done);
  receivers_.for_each(done.frame.identifier, [&](std::size_t node) {
    if (receives(node, done)) hand_over(node, done.frame);
  });
}

// A disturbance acts on the reception of every node, whether or not its filter accepts the frame.
void Bus::deliver_disturbed(const Transmission& done) {
  for (std::size_t node = 0; node < nodes_.size(); ++node) {
    if (!receives(node, done)) continue;
    const Reception reception =
        disturbance_->on_reception(done.frame, static_cast<NodeHandle>(node), done.start_us);
    if (reception.lost) continue;
    if (reception.delay_us > 0) {
      late_.emplace(done.end_us + reception.delay_us, LateFrame{node, done.frame, done.start_us});
    } else if (receivers_.accepts(node, done.frame.identifier)) {
      hand_over(node, done.frame);
    }
  }
}

void Bus::deliver_late() {
  const LateFrame late = late_.begin()->second;
  late_.erase(late_.begin());
  if (!receivers_.accepts(late.receiver, late.frame.identifier)) return;
  // The frame was in the controller's memory, which is lost if the node has left the bus since.
  if (nodes_[late.receiver].online_since_us <= late.start_us) hand_over(late.receiver, late.frame);
}

void Bus::hand_over(std::size_t receiver, const hal::CanFrame& frame) {
  Node& node = nodes_[receiver];
  ++node.counters.received;
  node.node->on_frame(frame, now_us_);
}

void Bus::count_sent(std::uint64_t start_us) {
  for (const std::size_t sender : senders_) {
    Node& node = nodes_[node_of(sender)];
    if (start_us - queue_of(sender).front().ready_us > kLate_us) ++node.counters.late;
    queue_of(sender).pop();
    node.errors.on_transmitted();
    ++node.counters.sent;
    if (node.errors.error_passive()) {
      suspend_if_passive(node);
      refresh_heads(node_of(sender));
    } else {
      refresh_head(sender);
    }
  }
}

void Bus::archive(StateArchive& archive) {
  if (std::ranges::any_of(nodes_, &Node::is_bridge))
    throw NotSaveable(
        "a simulation whose bus is bridged to the outside has no snapshots: what lives there has none");
  archive(now_us_, idle_from_us_, nodes_, online_, recovering_, dominant_since_us_, dominant_due_us_,
          receive_errors_, wire_, senders_, late_, usage_);
  if (archive.writes()) return;
  for (std::size_t i = 0; i < nodes_.size(); ++i) refresh_heads(i);
}

bool Bus::is_sender(std::size_t node) const {
  return std::ranges::any_of(senders_, [node](std::size_t sender) { return node_of(sender) == node; });
}

}  // namespace koboshi::sim_board
