#include "tools/run/live_link.h"

#include <thread>

#include "sim_board/can/transport/background_transport.h"

namespace koboshi::tools {
namespace {

// With one processor, the thread would take its time from the simulation all the same.
std::unique_ptr<sim::Transport> beside_the_simulation(std::unique_ptr<sim::Transport> transport) {
  if (!transport || !transport->is_slow() || std::thread::hardware_concurrency() < 2) return transport;
  return std::make_unique<sim::BackgroundTransport>(std::move(transport));
}

}  // namespace

LiveLink::LiveLink(const LiveOptions& options)
    : transport_(sim::open_transport(options.can, options.real_bus)),
      live_(options.realtime || (transport_ && transport_->is_live())),
      speed_(options.speed) {
  transport_ = beside_the_simulation(std::move(transport_));
}

void LiveLink::attach(sim::Bus& bus) {
  if (transport_) node_.emplace(bus, *transport_);
  if (live_) pacer_.emplace(bus.now_us(), speed_);
}

nlohmann::ordered_json LiveLink::report() const {
  nlohmann::ordered_json json;
  if (node_) {
    const sim::TransportNode::Counters& counters = node_->counters();
    json["can"] = {{"transport", transport_->place()},
                   {"frames_sent", counters.sent},
                   {"frames_lost", counters.lost},
                   {"frames_received", counters.received},
                   {"frames_refused", counters.refused}};
  }
  if (pacer_) {
    json["overruns"] = pacer_->overruns();
    json["largest_delay_us"] = pacer_->largest_delay_us();
  }
  return json;
}

}  // namespace koboshi::tools
