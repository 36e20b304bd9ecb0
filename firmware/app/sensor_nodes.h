#pragma once

#include <cstdint>
#include <span>

#include "firmware/canopen/frame.h"

namespace koboshi::app {

// NMT master of the sensors that are nodes of the bus: resets them together with the drives, and starts each
// after its boot-up message (CiA 302-2).
class SensorNodes {
 public:
  // Takes at most 32 nodes and ignores the rest. Both must outlive this object.
  SensorNodes(std::span<const std::uint8_t> node_ids, canopen::FrameSink& sink)
      : node_ids_(node_ids.first(node_ids.size() < kMax ? node_ids.size() : kMax)), sink_(sink) {}

  // Resets all nodes, in the next calls of `process`.
  void reset() {
    to_reset_ = all();
    to_start_ = 0;
  }
  // Takes every frame from the bus, to find the boot-up messages.
  void on_frame(const hal::CanFrame& frame) {
    if (!node_ids_.empty()) note_boot_up(frame);
  }
  // Sends the messages that are due. Nodes that have booted are started once `may_start` is true.
  void process(bool may_start) {
    if (to_reset_ != 0) send(canopen::NmtCommand::kResetNode, to_reset_);
    if (to_start_ != 0 && may_start) send(canopen::NmtCommand::kStart, to_start_);
  }

 private:
  static constexpr std::size_t kMax = 32;

  std::uint32_t all() const { return static_cast<std::uint32_t>((std::uint64_t{1} << node_ids_.size()) - 1); }
  void note_boot_up(const hal::CanFrame& frame);
  void send(canopen::NmtCommand command, std::uint32_t& due);

  std::span<const std::uint8_t> node_ids_;
  canopen::FrameSink& sink_;
  std::uint32_t to_reset_ = 0;  // bit i: node i is to be reset
  std::uint32_t to_start_ = 0;  // bit i: node i is to be started
};

}  // namespace koboshi::app
