#include "tools/run/live_link.h"

#include <fmt/core.h>

#include <stdexcept>
#include <thread>
#include <utility>

#include "sim_board/can/transport/background_transport.h"

namespace koboshi::tools {
namespace {

// A thread only helps where there is a second processor for it.
std::unique_ptr<sim_board::Transport> in_background(std::unique_ptr<sim_board::Transport> transport) {
  if (!transport || !transport->is_slow() || std::thread::hardware_concurrency() < 2) return transport;
  return std::make_unique<sim_board::BackgroundTransport>(std::move(transport));
}

}  // namespace

LiveLink::LiveLink(const LiveOptions& options, Warn warn)
    : LiveLink(options, sim_board::open_transport(options.can, options.transport), std::move(warn)) {}

LiveLink::LiveLink(const LiveOptions& options, std::unique_ptr<sim_board::Transport> transport, Warn warn)
    : transport_(std::move(transport)),
      live_(options.realtime || (transport_ && transport_->is_live())),
      speed_(options.speed.value_or(1.0)),
      warn_(std::move(warn)) {
  if (options.speed && !live_) {
    throw std::invalid_argument(
        "found --speed without a clock, expected --realtime or a live bus (--can socketcan, udp or slcan)");
  }
  transport_ = in_background(std::move(transport_));
}

void LiveLink::attach(sim_board::Bus& bus, const WallClock& wall) {
  if (transport_) node_.emplace(bus, *transport_);
  if (live_) pacer_.emplace(bus.now_us(), speed_, wall);
}

void LiveLink::attach(sim_board::Bus& bus) { attach(bus, interruptible(interrupt_)); }

void LiveLink::check_for_losses() {
  if (pacer_) {
    const std::uint64_t delay_us = pacer_->delay_us();
    if (delay_us <= kLate_us) warned_behind_ = false;  // it has caught up
    warn_once(
        delay_us > kOverload_us, warned_behind_,
        fmt::format("{} ms behind the clock, frames are late: too much for this machine", delay_us / 1000));
  }
  if (!node_) return;
  const sim_board::TransportNode::Counters counters = node_->counters();
  // A channel that no program has opened yet accepts no frames; none of them counts as lost.
  warn_once(counters.lost > 0 && counters.sent > 0, warned_lost_,
            "frames are lost: outside there is no room for them");
  warn_once(counters.refused > 0, warned_refused_,
            "frames from outside are lost: they are more than the bus can carry");
  warn_once(counters.stalls > 0, warned_stalled_,
            "frames from outside are late: they are more than the bus can carry");
  warn_once(counters.dropped > 0, warned_dropped_,
            "frames from outside are lost: they come faster than this machine takes them");
}

void LiveLink::warn_once(bool occurs, bool& warned, const std::string& text) {
  if (occurs && !warned) warn_(text);
  warned = warned || occurs;
}

nlohmann::ordered_json LiveLink::report() const {
  nlohmann::ordered_json json;
  if (node_) {
    const sim_board::TransportNode::Counters& counters = node_->counters();
    json["can"] = {{"transport", transport_->place()},     {"frames_sent", counters.sent},
                   {"frames_lost", counters.lost},         {"frames_sent_late", counters.late_sent},
                   {"frames_received", counters.received}, {"frames_refused", counters.refused},
                   {"frames_dropped", counters.dropped},   {"frames_received_late", counters.late_received}};
  }
  if (pacer_) {
    json["overruns"] = pacer_->overruns();
    json["largest_delay_us"] = pacer_->largest_delay_us();
  }
  return json;
}

}  // namespace koboshi::tools
