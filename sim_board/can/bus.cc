#include "sim_board/can/bus.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "sim_board/can/frame_bits.h"

namespace koboshi::sim {
namespace {

std::uint32_t priority(const hal::CanFrame& frame) {
  return frame.identifier * 2u + (frame.remote ? 1u : 0u);
}

// As the wire carries it: with nothing beyond its size.
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

NodeHandle Bus::attach(BusNode& node, const AcceptanceFilter& filter, std::size_t transmit_capacity) {
  nodes_.push_back({.node = &node,
                    .queue = TransmitQueue(transmit_capacity),
                    .errors = {},
                    .counters = {},
                    .online_since_us = now_us_});
  heads_.emplace_back();
  filters_.push_back(filter);
  receivers_stale_ = true;
  senders_.reserve(nodes_.size());
  ++online_;
  return static_cast<NodeHandle>(nodes_.size() - 1);
}

void Bus::set_filter(NodeHandle node, const AcceptanceFilter& filter) {
  filters_[index(node)] = filter;
  receivers_stale_ = true;
}

bool Bus::queue(NodeHandle node, const hal::CanFrame& frame, std::uint64_t ready_us) {
  Node& sender = nodes_[index(node)];
  if (!sender.powered) return false;
  if (!sender.queue.push({without_rest(frame), std::max(ready_us, now_us_)})) {
    ++sender.counters.overruns;
    return false;
  }
  refresh_head(index(node));
  return true;
}

void Bus::advance_to(std::uint64_t time_us) {
  assert(time_us >= now_us_);
  for (;;) {
    if (wire_.has_value()) {
      if (wire_->end_us > time_us) break;
      now_us_ = wire_->end_us;
      finish();
    } else if (!start_next(time_us)) {
      break;
    }
  }
  now_us_ = time_us;
}

BusUsage Bus::usage() const {
  BusUsage usage = usage_;
  usage.time_us = now_us_;
  if (wire_.has_value()) {
    usage.busy_us += now_us_ - wire_->start_us;
  } else if (idle_from_us_ > now_us_) {
    usage.busy_us -= idle_from_us_ - now_us_;  // the intermission has not passed yet
  }
  return usage;
}

void Bus::refresh_head(std::size_t node) {
  const Node& sender = nodes_[node];
  if (sender.queue.empty() || sender.online_since_us == kNever) {
    heads_[node] = {};
  } else {
    const QueuedFrame& front = sender.queue.front();
    heads_[node] = {std::max(front.ready_us, sender.hold_until_us), priority(front.frame)};
  }
}

std::uint64_t Bus::next_start_us() const {
  std::uint64_t ready_us = kNever;
  for (const Head& head : heads_) ready_us = std::min(ready_us, head.ready_us);
  return std::max(ready_us, idle_from_us_);
}

// Starts the next transmission if that happens before the given time.
bool Bus::start_next(std::uint64_t until_us) {
  if (std::exchange(receivers_stale_, false)) receivers_.rebuild(filters_);
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

void Bus::gather_senders(std::uint64_t start_us) {
  senders_.clear();
  std::uint32_t best = std::numeric_limits<std::uint32_t>::max();
  for (std::size_t i = 0; i < heads_.size(); ++i) {
    if (heads_[i].ready_us > start_us || heads_[i].priority > best) continue;
    if (heads_[i].priority < best) senders_.clear();
    best = heads_[i].priority;
    senders_.push_back(i);
  }
}

Bus::Transmission Bus::make_transmission(std::uint64_t start_us) {
  const int destroyed_after_bits = senders_.size() > 1 ? settle_collision() : 0;
  const hal::CanFrame& frame = nodes_[senders_.front()].queue.front().frame;
  int bits = frame_bits(frame);
  Outcome outcome = Outcome::kDelivered;
  if (destroyed_after_bits > 0) {
    outcome = Outcome::kDestroyed;
    bits = destroyed_after_bits + kErrorFrameBits;
  } else if (disturbance_ != nullptr && disturbance_->destroys(frame, start_us)) {
    outcome = Outcome::kDestroyed;
    bits = bits - kUnstuffedTailBits + kErrorFrameBits;  // found at the end of the CRC sequence
  } else if (online_ == senders_.size()) {
    outcome = Outcome::kUnacknowledged;  // the ACK slot stays recessive; nobody else adds an error flag
    bits = bits - kAckDelimiterBits - kEndOfFrameBits + kErrorFlagBits + kErrorDelimiterBits;
  }
  if (recovering_ > 0) {
    for (Node& node : nodes_) {
      if (node.recovered_us != kNever)
        node.recovered_us += duration_us(bits + kIntermissionBits - kRecessiveEndBits);
    }
  }
  return {frame, start_us, start_us + duration_us(bits), outcome};
}

void Bus::finish() {
  const Transmission done = *wire_;
  wire_.reset();
  idle_from_us_ = done.end_us + duration_us(kIntermissionBits);
  usage_.busy_us += idle_from_us_ - done.start_us;
  if (done.outcome != Outcome::kDelivered) {
    count_errors(done.outcome);
    return;
  }
  count_sent();
  if (receive_errors_) count_receptions();
  if (observer_ != nullptr) observer_->on_bus_frame(done.frame, done.start_us, done.end_us);
  deliver(done);
}

void Bus::deliver(const Transmission& done) {
  for (const std::uint16_t receiver : receivers_.of(done.frame.identifier)) {
    Node& node = nodes_[receiver];
    if (node.online_since_us > done.start_us || is_sender(receiver)) continue;
    ++node.counters.received;
    node.node->on_frame(done.frame, done.end_us);
  }
}

void Bus::count_sent() {
  ++usage_.frames;
  for (const std::size_t sender : senders_) {
    Node& node = nodes_[sender];
    node.queue.pop();
    node.errors.on_transmitted();
    ++node.counters.sent;
    suspend_if_passive(node);
    refresh_head(sender);
  }
}

bool Bus::is_sender(std::size_t node) const {
  return std::find(senders_.begin(), senders_.end(), node) != senders_.end();
}

}  // namespace koboshi::sim
