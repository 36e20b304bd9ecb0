#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "sim_board/can/transport/transport.h"
#include "sim_board/can/transport/transport_node.h"
#include "tools/run/interrupt.h"
#include "tools/run/pacer.h"

namespace koboshi::tools {

// The connection of a simulation to other programs and to the wall clock.
struct LiveOptions {
  std::string can = "none";  // see sim_board::open_transport
  sim_board::TransportOptions transport{};
  bool realtime = false;  // in real time; implied by a live transport
  // Simulated seconds per second of the wall clock, 1 by default. Only in real time.
  std::optional<double> speed{};

  friend bool operator==(const LiveOptions&, const LiveOptions&) = default;
};

// Connects the bus of a simulation to a transport, and its time to the wall clock.
class LiveLink {
 public:
  // Delay beyond which frames count as late: one control cycle.
  static constexpr std::uint64_t kLate_us = 10'000;
  // Delay beyond which a warning says that the machine is too slow.
  static constexpr std::uint64_t kOverload_us = 100'000;
  // Receives a sentence when frames begin to be lost or the simulation falls behind.
  using Warn = std::function<void(const std::string&)>;

  // Opens the transport. Throws what sim_board::open_transport throws, and std::invalid_argument for a speed
  // without real time.
  explicit LiveLink(const LiveOptions& options, Warn warn = {});
  // Takes an open transport, or null.
  LiveLink(const LiveOptions& options, std::unique_ptr<sim_board::Transport> transport, Warn warn = {});

  // Connects the bus, from its present time on. By default a signal ends the waits for the wall clock.
  void attach(sim_board::Bus& bus, const WallClock& wall);
  void attach(sim_board::Bus& bus);
  // Call these before and after each millisecond of the simulation.
  void before(std::uint64_t now_us) {
    if (node_) node_->poll(now_us, pacer_ && pacer_->delay_us() > kLate_us);
  }
  void after(std::uint64_t now_us) {
    if (transport_) transport_->flush();
    if (pacer_) pacer_->wait_for(now_us);
    if (warn_ && now_us % kWarnPeriod_us == 0) check_for_losses();
  }
  // Returns the signal by which the user ends the run, such as Ctrl-C. Polls the system only now and then.
  std::optional<int> interrupted() {
    return ++calls_ % kCallsPerPoll == 0 ? interrupt_.requested() : std::nullopt;
  }
  // Lets signals end the program from now on, without its knowledge.
  void release_signals() { interrupt_.release(); }

  bool is_live() const { return live_; }
  // Null without a transport.
  const sim_board::Transport* transport() const { return transport_.get(); }
  // Null without real time, and before attach().
  const Pacer* pacer() const { return pacer_ ? &*pacer_ : nullptr; }
  // Frames carried, lost and late, and overruns. Null without transport and real time.
  nlohmann::ordered_json report() const;

 private:
  static constexpr std::uint64_t kCallsPerPoll = 50;  // one call per millisecond of a run
  static constexpr std::uint64_t kWarnPeriod_us = 50'000;

  void check_for_losses();
  void warn_once(bool occurs, bool& warned, const std::string& text);

  // First member: threads that start later inherit the blocked signals.
  Interrupt interrupt_;
  std::unique_ptr<sim_board::Transport> transport_;
  bool live_;
  double speed_;
  std::optional<sim_board::TransportNode> node_;
  std::optional<Pacer> pacer_;
  std::uint64_t calls_ = 0;
  Warn warn_;
  // The warnings that were given.
  bool warned_behind_ = false;
  bool warned_lost_ = false;
  bool warned_refused_ = false;
  bool warned_stalled_ = false;
  bool warned_dropped_ = false;
};

}  // namespace koboshi::tools
