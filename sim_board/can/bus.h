#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "hal/port/can.h"
#include "sim_board/can/acceptance.h"
#include "sim_board/can/disturbance.h"
#include "sim_board/can/error_counters.h"
#include "sim_board/can/node.h"
#include "sim_board/can/observer.h"
#include "sim_board/can/transmit_queue.h"
#include "sim_board/state/archive.h"

namespace koboshi::sim {

// What happened on the bus since it was made, up to `time_us`.
struct BusUsage {
  std::uint64_t time_us = 0;
  std::uint64_t busy_us = 0;       // frames, error frames and the intermission after them
  std::uint64_t frames = 0;        // sound ones
  std::uint64_t error_frames = 0;  // for whatever reason
  std::uint64_t collisions = 0;    // two nodes sent the same identifier with different contents
};

// Share of the bus, 0..1, that was busy between two looks at its usage.
double bus_load(const BusUsage& from, const BusUsage& to);

struct NodeCounters {
  std::uint64_t sent = 0;
  std::uint64_t received = 0;
  std::uint64_t overruns = 0;  // frames lost because a transmit FIFO was full
  std::uint64_t late = 0;      // of those sent, how many had been ready for longer than Bus::kLate_us
};

// An event-driven model of a classic CAN bus with its controllers, exact to the bit time.
//
// Each node has the transmit FIFOs of hal::CanPort. A frame becomes eligible at its ready time, first in
// first out in each FIFO. When the bus is idle, the lowest identifier among the eligible heads of all FIFOs
// wins (of equal identifiers the data frame). So nothing delays a frame by more than the one on the wire, but
// for what has a lower identifier or stands before it in its own FIFO. The frame occupies
// its bits with stuffing; at the end of its last EOF bit every other node that was on the bus since its start
// and accepts the identifier is told; the next frame starts at the earliest after three bits of intermission.
//
// Several nodes with the very same frame send it at once. With the same identifier and different contents the
// first different bit is a bit error for those that sent it recessive: the error-active ones destroy the
// frame with an error flag and all count and try again; the error-passive ones cannot disturb it, count alone
// and lose.
//
// A frame that no other node acknowledges is repeated without end; its sender becomes error-passive and stays
// so.
//
// A disturbance may destroy, double, lose and delay frames.
//
// Times are in microseconds and never decrease. Memory is taken only when nodes are attached, by the first
// advance after that or after a change of filters, and for frames that a disturbance delays.
class Bus {
 public:
  // On a bus with room to spare a frame waits for less: a control cycle of the robot.
  static constexpr std::uint64_t kLate_us = 10'000;

  explicit Bus(std::uint64_t bit_time_us = 1);

  // The node must outlive the bus. It is on the bus from now on. The capacities are those of its FIFOs, by
  // hal::TransmitFifo.
  using TransmitCapacity = std::array<std::size_t, hal::kTransmitFifos>;
  NodeHandle attach(BusNode& node, const AcceptanceFilter& filter, const TransmitCapacity& capacity);
  // All FIFOs as long as that.
  NodeHandle attach(BusNode& node, const AcceptanceFilter& filter, std::size_t capacity) {
    return attach(node, filter, {capacity, capacity, capacity});
  }
  void set_filter(NodeHandle node, const AcceptanceFilter& filter);
  // Marks a node that stands for others outside of the simulation: from now on the bus cannot be saved.
  void bridge(NodeHandle node) { nodes_[index(node)].is_bridge = true; }

  // A node without power: its FIFOs and error counts are lost, a frame that it was just sending ends in an
  // error frame. With power again it takes part in what starts from then on.
  void power_off(NodeHandle node);
  void power_on(NodeHandle node);
  bool powered(NodeHandle node) const { return nodes_[index(node)].powered; }

  // Appends to one of the node's transmit FIFOs. A ready time in the past means now. The frame keeps its
  // place until it has been sent. False when the FIFO is full (counted) or the node has no power. Nodes may
  // call it from within `on_frame`. Precondition: identifier at most 0x7FF, size at most 8.
  [[nodiscard]] bool queue(NodeHandle node, const hal::CanFrame& frame, std::uint64_t ready_us);
  std::size_t transmit_space(NodeHandle node, hal::TransmitFifo fifo) const {
    return nodes_[index(node)].queues[fifo].space();
  }
  // Whether a frame of this FIFO has yet to be sent.
  bool transmit_pending(NodeHandle node, hal::TransmitFifo fifo) const {
    return !nodes_[index(node)].queues[fifo].empty();
  }

  // A short circuit, or a transceiver that has failed: the bus is dominant from now on, or no longer. What is
  // on the wire is destroyed, and nothing starts. Of each eight dominant bits, the node that was sending
  // counts eight transmit errors, and every other one eight receive errors, until the one is bus-off and the
  // others are error-passive; a recovery from bus-off stands still.
  void set_dominant(bool dominant);

  // Everything that ends up to and including this time is delivered; a frame that could start at this very
  // time waits for what else may be queued for it. Not to be called from within `on_frame`.
  void advance_to(std::uint64_t time_us);
  std::uint64_t now_us() const { return now_us_; }

  // Receive overruns are the business of who owns a receive ring: zero here.
  hal::CanStatus status(NodeHandle node) const;
  // Starts the recovery of a node that is bus-off: 128 times 11 recessive bits, that is 1408 bit times of
  // idle bus, or fewer idle ones with frames between, each of which ends in 11 recessive bits. No effect in
  // the other states.
  void recover(NodeHandle node);

  NodeCounters counters(NodeHandle node) const { return nodes_[index(node)].counters; }
  BusUsage usage() const;

  // Null for none. They must outlive the bus or be taken away before.
  void set_observer(BusObserver* observer) { observer_ = observer; }
  void set_disturbance(BusDisturbance* disturbance) { disturbance_ = disturbance; }

  // Saves or restores the bus with the CAN controllers of its nodes. Nodes, observer and disturbance keep
  // their own states; which nodes there are, and their filters, is no state. Throws NotSaveable where a node
  // is a bridge, std::logic_error where nodes were attached since.
  void archive(StateArchive& archive);

 private:
  static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

  struct Node {
    BusNode* node;
    std::array<TransmitQueue, hal::kTransmitFifos> queues;  // by hal::TransmitFifo
    ErrorCounters errors;
    NodeCounters counters;
    bool powered = true;
    std::uint64_t online_since_us;        // kNever without power and while bus-off
    std::uint64_t hold_until_us = 0;      // suspended transmission
    std::uint64_t recovered_us = kNever;  // end of a recovery from bus-off under way
    bool is_bridge = false;

    void archive(StateArchive& archive) {
      archive(queues, errors, counters, powered, online_since_us, hold_until_us, recovered_us);
    }
  };

  // What takes part in an arbitration, beside each other in memory: the head of a FIFO, those of a node in a
  // row.
  struct Head {
    std::uint64_t ready_us = kNever;
    std::uint32_t priority = 0;  // identifier and RTR bit; the lowest wins
  };

  enum class Outcome { kDelivered, kDoubled, kUnacknowledged, kDestroyed };

  struct Transmission {
    hal::CanFrame frame;
    std::uint64_t start_us;
    std::uint64_t end_us;
    Outcome outcome;
  };

  // A frame of which a receiver is told only after its end.
  struct LateFrame {
    std::size_t receiver;
    hal::CanFrame frame;
    std::uint64_t start_us;
  };

  static constexpr std::size_t index(NodeHandle node) { return static_cast<std::size_t>(node); }
  static constexpr std::size_t node_of(std::size_t head) { return head / hal::kTransmitFifos; }
  TransmitQueue& queue_of(std::size_t head) {
    return nodes_[node_of(head)].queues[head % hal::kTransmitFifos];
  }
  std::uint64_t duration_us(int bits) const { return static_cast<std::uint64_t>(bits) * bit_time_us_; }

  static int bits_after(Outcome outcome);
  std::uint64_t next_late_us() const { return late_.empty() ? kNever : late_.begin()->first; }
  void refresh_heads(std::size_t node);
  std::uint64_t next_start_us() const;
  bool start_next(std::uint64_t until_us);
  void gather_senders(std::uint64_t start_us);
  int settle_collision();
  Transmission make_transmission(std::uint64_t start_us);
  Outcome outcome_of(const hal::CanFrame& frame, std::uint64_t start_us);
  void finish();
  void deliver(const Transmission& done);
  void deliver_late();
  void hand_over(std::size_t receiver, const hal::CanFrame& frame);
  void count_sent(std::uint64_t start_us);
  void count_receptions();
  void count_errors(Outcome outcome);
  void suspend_if_passive(Node& node);
  bool is_sender(std::size_t node) const;
  void complete_recoveries(std::uint64_t until_us);
  void count_dominant_bits();
  void leave(std::size_t node);

  std::uint64_t bit_time_us_;
  std::uint64_t now_us_ = 0;
  std::uint64_t idle_from_us_ = 0;  // end of the last intermission
  std::vector<Node> nodes_;
  std::vector<Head> heads_;
  std::vector<AcceptanceFilter> filters_;
  ReceiverTable receivers_;
  bool receivers_stale_ = false;
  std::size_t online_ = 0;
  std::size_t recovering_ = 0;
  std::optional<std::uint64_t> dominant_since_us_;
  std::uint64_t dominant_due_us_ = kNever;  // the next eight dominant bits
  bool receive_errors_ = false;             // some node's receive error count is not zero
  std::optional<Transmission> wire_;
  std::vector<std::size_t> senders_;  // of the transmission on the wire; heads, at most one a node
  std::multimap<std::uint64_t, LateFrame> late_;  // by the time at which the receiver is told
  BusUsage usage_;
  BusObserver* observer_ = nullptr;
  BusDisturbance* disturbance_ = nullptr;
};

}  // namespace koboshi::sim
