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

namespace koboshi::sim_board {

// Statistics of the bus from its creation to `time_us`.
struct BusUsage {
  std::uint64_t time_us = 0;
  std::uint64_t busy_us = 0;       // frames, error frames and the following intermissions
  std::uint64_t frames = 0;        // valid frames
  std::uint64_t error_frames = 0;  // of any cause
  std::uint64_t collisions = 0;    // simultaneous frames with the same identifier and different contents
};

// Returns the bus load, 0..1, between two readings of the usage.
double bus_load(const BusUsage& from, const BusUsage& to);

struct NodeCounters {
  std::uint64_t sent = 0;
  std::uint64_t received = 0;
  std::uint64_t overruns = 0;  // frames lost because a transmit FIFO was full
  std::uint64_t late = 0;      // sent frames that had been ready for longer than Bus::kLate_us
};

// Event-driven model of a classic CAN bus and its controllers with bit-time resolution.
//
// Each node has the transmit FIFOs of hal::CanPort. A frame becomes eligible at its ready time; each FIFO
// keeps its order. When the bus is idle, the lowest identifier among the eligible heads of all FIFOs wins
// (with equal identifiers, the data frame). A frame is therefore delayed only by the frame on the wire, by
// lower identifiers and by earlier frames in its own FIFO. The frame occupies its bits with stuffing. At the
// end of its last EOF bit it is delivered to every other node that accepts the identifier and has been on the
// bus since the frame's start. The next frame starts after at least three bits of intermission.
//
// Nodes with identical frames send them simultaneously. With the same identifier and different contents, the
// first different bit is a bit error for the nodes that sent it recessive. Error-active ones destroy the
// frame with an error flag, and all senders count the error and retry. Error-passive ones cannot disturb the
// frame; only they count the error and they lose arbitration.
//
// A frame that no other node acknowledges is repeated without end; its sender becomes and stays
// error-passive.
//
// A BusDisturbance can destroy, double, drop and delay frames.
//
// Times are in microseconds and never decrease. Memory is allocated only when nodes are attached and for
// frames that a disturbance delays.
class Bus {  // Large: one short function per stage of a frame
 public:
  // Threshold for late frames: one control cycle of the robot. On a bus with spare capacity frames wait less.
  static constexpr std::uint64_t kLate_us = 10'000;

  explicit Bus(std::uint64_t bit_time_us = 1);

  // Attaches a node, which is then on the bus. The node must outlive the bus. The capacities are those of its
  // FIFOs, by hal::TransmitFifo.
  using TransmitCapacity = std::array<std::size_t, hal::kTransmitFifos>;
  NodeHandle attach(BusNode& node, const AcceptanceFilter& filter, const TransmitCapacity& capacity);
  // Attaches a node with FIFOs of equal capacity.
  NodeHandle attach(BusNode& node, const AcceptanceFilter& filter, std::size_t capacity) {
    return attach(node, filter, {capacity, capacity, capacity});
  }
  // Nodes may call it from `on_frame`.
  void set_filter(NodeHandle node, const AcceptanceFilter& filter) { receivers_.set(index(node), filter); }
  // Marks a node as a bridge to nodes outside the simulation. The bus can then no longer be saved.
  void bridge(NodeHandle node) { nodes_[index(node)].is_bridge = true; }

  // Switches a node's power. Without power, its FIFOs and error counts are lost, and a frame in transmission
  // ends in an error frame. After power-on, it participates in transmissions that start from then on.
  void power_off(NodeHandle node);
  void power_on(NodeHandle node);
  bool powered(NodeHandle node) const { return nodes_[index(node)].powered; }

  // Appends a frame to a transmit FIFO of the node. A ready time in the past means now. The frame occupies
  // its slot until it has been sent. Returns false if the FIFO is full (counted) or the node has no power.
  // Nodes may call it from `on_frame`. Precondition: identifier at most 0x7FF, size at most 8.
  [[nodiscard]] bool queue(NodeHandle node, const hal::CanFrame& frame, std::uint64_t ready_us);
  std::size_t transmit_space(NodeHandle node, hal::TransmitFifo fifo) const {
    return nodes_[index(node)].queues[fifo].space();
  }
  // Returns whether this FIFO contains frames.
  bool transmit_pending(NodeHandle node, hal::TransmitFifo fifo) const {
    return !nodes_[index(node)].queues[fifo].empty();
  }

  // Forces the bus dominant, as a short circuit or a defective transceiver does, or ends this. The frame on
  // the wire is destroyed, and none starts. For each eight dominant bits, the transmitting node counts eight
  // transmit errors and every other node eight receive errors, until the former is bus-off and the others are
  // error-passive. Recoveries from bus-off are suspended.
  void set_dominant(bool dominant);

  // Delivers all frames that end up to and including this time. A frame that could start exactly at this time
  // waits, because further frames may still be queued for it. Must not be called from `on_frame`.
  void advance_to(std::uint64_t time_us);
  std::uint64_t now_us() const { return now_us_; }

  // CAN status of the node, as of ErrorCounters::status.
  hal::CanStatus status(NodeHandle node) const { return nodes_[index(node)].errors.status(); }
  // Starts the recovery of a bus-off node: 128 occurrences of 11 recessive bits. That is 1408 bit times of
  // idle bus, or fewer with frames in between, each of which ends in 11 recessive bits. No effect in other
  // states.
  void recover(NodeHandle node);

  NodeCounters counters(NodeHandle node) const { return nodes_[index(node)].counters; }
  BusUsage usage() const;

  // Null removes it. Both must outlive the bus or be removed before.
  void set_observer(BusObserver* observer) { observer_ = observer; }
  void set_disturbance(BusDisturbance* disturbance) { disturbance_ = disturbance; }

  // Saves or restores the bus and the CAN controllers of its nodes. Nodes, observer and disturbance archive
  // their own states; the set of nodes and their filters are not archived: a node that changes its filter
  // sets it again when it is restored. Throws NotSaveable if a node is a bridge, and std::logic_error if
  // nodes have been attached since.
  void archive(StateArchive& archive);

 private:
  static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

  struct Node {
    BusNode* node;
    std::array<TransmitQueue, hal::kTransmitFifos> queues;  // by hal::TransmitFifo
    ErrorCounters errors;
    NodeCounters counters;
    bool powered = true;
    std::uint64_t online_since_us;        // kNever without power and in bus-off
    std::uint64_t hold_until_us = 0;      // end of the suspended transmission
    std::uint64_t recovered_us = kNever;  // end of a recovery from bus-off in progress
    bool is_bridge = false;

    void archive(StateArchive& archive) {
      archive(queues, errors, counters, powered, online_since_us, hold_until_us, recovered_us);
    }
  };

  // A participant of the arbitration: the head of a FIFO. All heads are contiguous in memory, those of one
  // node in a row.
  struct Head {
    std::uint64_t ready_us = kNever;
    std::uint32_t priority = 0;  // identifier and RTR bit; the lowest value wins
  };

  enum class Outcome { kDelivered, kDoubled, kUnacknowledged, kDestroyed };

  struct Transmission {
    hal::CanFrame frame;
    std::uint64_t start_us;
    std::uint64_t end_us;
    Outcome outcome;
  };

  // A frame with delayed delivery to one receiver.
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
  void refresh_head(std::size_t head);
  void refresh_heads(std::size_t node);
  template <typename Visit>
  void for_each_waiting(Visit visit) const {
    for (std::size_t i = 0; i < waiting_.size(); ++i) for_each_bit(waiting_[i], kWordBits * i, visit);
  }
  std::uint64_t next_start_us() const;
  bool start_next(std::uint64_t until_us);
  void gather_senders(std::uint64_t start_us);
  int settle_collision();
  Transmission make_transmission(std::uint64_t start_us);
  Outcome outcome_of(const hal::CanFrame& frame, std::uint64_t start_us);
  void finish();
  void deliver(const Transmission& done);
  void deliver_disturbed(const Transmission& done);
  void deliver_late();
  void hand_over(std::size_t receiver, const hal::CanFrame& frame);
  void count_sent(std::uint64_t start_us);
  void count_receptions();
  void count_errors(Outcome outcome);
  void suspend_if_passive(Node& node);
  bool is_sender(std::size_t node) const;
  bool receives(std::size_t node, const Transmission& done) const {
    return nodes_[node].online_since_us <= done.start_us && !is_sender(node);
  }
  void complete_recoveries(std::uint64_t until_us);
  void count_dominant_bits();
  void leave(std::size_t node);

  std::uint64_t bit_time_us_;
  std::uint64_t now_us_ = 0;
  std::uint64_t idle_from_us_ = 0;  // end of the last intermission
  std::vector<Node> nodes_;
  std::vector<Head> heads_;
  std::vector<std::uint64_t> waiting_;  // a bit for each head: it has a frame
  ReceiverTable receivers_;
  std::size_t online_ = 0;
  std::size_t recovering_ = 0;
  std::optional<std::uint64_t> dominant_since_us_;
  std::uint64_t dominant_due_us_ = kNever;  // time of the next eight dominant bits
  bool receive_errors_ = false;             // any node's receive error count is not zero
  std::optional<Transmission> wire_;
  std::vector<std::size_t> senders_;  // of the transmission on the wire; indices of heads, at most one per
                                      // node
  std::multimap<std::uint64_t, LateFrame> late_;  // by time of delivery
  BusUsage usage_;
  BusObserver* observer_ = nullptr;
  BusDisturbance* disturbance_ = nullptr;
};

}  // namespace koboshi::sim_board
