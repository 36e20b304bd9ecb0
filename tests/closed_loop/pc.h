#pragma once

#include <deque>
#include <functional>

#include "sim_board/can/transport/transport.h"
#include "simulation/assembly/simulation.h"

namespace koboshi::test {

// A PC on the bus of a simulation, for tools that use a transport. The simulation advances while the PC
// waits.
class Pc final : public sim_board::Transport, private sim_board::BusNode {
 public:
  // Receives the SDO answers of the node with this id. Calls `meanwhile` after each millisecond. All
  // arguments must outlive the PC.
  Pc(
      simulation::Simulation& simulation, std::uint8_t node_id, std::function<void()> meanwhile = [] {})
      : simulation_(simulation),
        node_id_(node_id),
        meanwhile_(std::move(meanwhile)),
        handle_(
            simulation.board().electronics().bus().attach(*this, sim_board::AcceptanceFilter::all(), 64)) {}

  bool send(const hal::CanFrame& frame, std::uint64_t) override {
    // Only simulated time empties the controller's FIFO, so the PC advances it while it waits.
    constexpr int kPatience_ms = 100;
    for (int waited_ms = 0; waited_ms < kPatience_ms; ++waited_ms) {
      if (simulation_.board().electronics().bus().queue(handle_, frame, simulation_.board().now_us()))
        return true;
      advance();
    }
    return false;
  }
  std::optional<hal::CanFrame> receive() override {
    if (heard_.empty()) advance();
    if (heard_.empty()) return std::nullopt;
    const hal::CanFrame frame = heard_.front();
    heard_.pop_front();
    return frame;
  }
  void advance() {
    simulation_.advance();
    meanwhile_();
  }
  void advance_until_us(std::uint64_t end_us) {
    while (simulation_.board().now_us() < end_us) advance();
  }
  std::string place() const override { return "the simulation"; }

 private:
  void on_frame(const hal::CanFrame& frame, std::uint64_t) override {
    if (frame.identifier == canopen::kSdoResponseBase + node_id_) heard_.push_back(frame);
  }

  simulation::Simulation& simulation_;
  std::uint8_t node_id_;
  std::function<void()> meanwhile_;
  sim_board::NodeHandle handle_;
  std::deque<hal::CanFrame> heard_;
};

}  // namespace koboshi::test
