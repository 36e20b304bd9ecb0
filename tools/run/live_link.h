#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "sim_board/can/transport/transport_node.h"
#include "tools/run/interrupt.h"
#include "tools/run/pacer.h"

namespace koboshi::tools {

// How a simulation is joined to the world outside.
struct LiveOptions {
  std::string can = "none";  // see sim::open_transport
  bool real_bus = false;     // allows an interface that is neither vcan nor vxcan
  bool realtime = false;     // by the clock on the wall; always so with a live transport
  std::optional<double> speed =
      {};  // simulated seconds in one of the wall clock, 1 unless given; refused without it

  friend bool operator==(const LiveOptions&, const LiveOptions&) = default;
};

// Joins the bus of a simulation to a transport, and its time to the clock on the wall.
class LiveLink {
 public:
  // Further behind the clock than this, the frames that are carried either way count as late: a control
  // cycle.
  static constexpr std::uint64_t kLate_us = 10'000;
  // And so far behind, the machine is too slow, or what it carries too much, and a warning says so.
  static constexpr std::uint64_t kOverload_us = 100'000;
  // Told in a sentence when frames begin to be lost, or the simulation to fall behind.
  using Warn = std::function<void(const std::string&)>;

  // Opens the transport. Throws what sim::open_transport throws, and std::invalid_argument for a speed where
  // nothing goes by the wall clock.
  explicit LiveLink(const LiveOptions& options, Warn warn = {});
  // With a transport that is open already, or none.
  LiveLink(const LiveOptions& options, std::unique_ptr<sim::Transport> transport, Warn warn = {});

  // Begins, with a bus that stands at its present time.
  void attach(sim::Bus& bus, const WallClock& wall = {});
  // Before and after each millisecond of the simulation.
  void before(std::uint64_t now_us) {
    if (node_) node_->poll(now_us, pacer_ && pacer_->delay_us() > kLate_us);
  }
  void after(std::uint64_t now_us) {
    if (transport_) transport_->flush();
    if (pacer_) pacer_->wait_for(now_us);
    if (warn_ && now_us % kWarnPeriod_us == 0) look_for_troubles();
  }
  // The signal by which the user wants an end, such as Ctrl-C. Asks the system now and then only.
  std::optional<int> interrupted() {
    return ++asked_ % kAsksACheck == 0 ? interrupt_.requested() : std::nullopt;
  }

  bool is_live() const { return live_; }
  // Where others find the bus; null without a transport.
  const sim::Transport* transport() const { return transport_.get(); }
  // What holds the time back; null where nothing does, and before attach().
  const Pacer* pacer() const { return pacer_ ? &*pacer_ : nullptr; }
  // What became of it: frames carried, lost and late, overruns. Null when there was neither transport nor
  // pacing.
  nlohmann::ordered_json report() const;

 private:
  static constexpr std::uint64_t kAsksACheck = 50;  // milliseconds, as a run asks
  static constexpr std::uint64_t kWarnPeriod_us = 50'000;

  void look_for_troubles();
  void warn_once(bool trouble, bool& told, const std::string& text);

  // Before any thread is started, so that none of them is ended by Ctrl-C.
  Interrupt interrupt_;
  std::unique_ptr<sim::Transport> transport_;
  bool live_;
  double speed_;
  std::optional<sim::TransportNode> node_;
  std::optional<Pacer> pacer_;
  std::uint64_t asked_ = 0;
  Warn warn_;
  // Which troubles were told of.
  bool told_behind_ = false;
  bool told_lost_ = false;
  bool told_refused_ = false;
  bool told_stalled_ = false;
  bool told_dropped_ = false;
};

}  // namespace koboshi::tools
