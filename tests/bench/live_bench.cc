// What a live transport costs a tick of 10 ms in wall time: two runs of the same walk side by side, tick by
// tick, one of them on the transport. Nobody waits for the clock. Prints one JSON document.
//
//   live_bench TRANSPORT [SIMULATED_SECONDS]

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "sim_board/scenario/reader.h"
#include "tools/run/live_link.h"
#include "tools/run/simulation.h"

namespace {

using namespace koboshi;
using Clock = std::chrono::steady_clock;

constexpr double kNeverWaits = 1e6;  // simulated seconds in one of the wall

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// A walk and what joins it to the world outside, as koboshi run has them.
class Walk {
 public:
  Walk(const sim::Scenario& scenario, const std::string& transport)
      : link_({.can = transport, .speed = kNeverWaits}), simulation_(scenario) {
    link_.attach(simulation_.board().bus());
  }

  double tick_us() {
    const auto start = Clock::now();
    for (std::uint64_t i = 0; i < sim::SimBoard::kTick_us / sim::SimBoard::kService_us; ++i) {
      link_.before(simulation_.board().now_us());
      simulation_.advance();
      link_.after(simulation_.board().now_us());
    }
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
  }
  bool finished() const { return simulation_.finished(); }
  nlohmann::ordered_json report() const { return link_.report(); }

 private:
  tools::LiveLink link_;
  tools::Simulation simulation_;
};

void measure(const std::string& transport, const std::string& seconds) {
  const std::vector<sim::Override> overrides{{"physics.stepper", "lumped"}, {"duration_s", seconds}};
  const sim::Scenario scenario = sim::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/walk.yaml", overrides);
  Walk alone(scenario, "none");
  Walk live(scenario, transport);
  std::vector<double> alone_us;
  std::vector<double> live_us;
  std::vector<double> extra_us;
  while (!live.finished()) {
    alone_us.push_back(alone.tick_us());
    live_us.push_back(live.tick_us());
    extra_us.push_back(live_us.back() - alone_us.back());
  }
  fmt::print(
      "{{\"transport\": \"{}\", \"ticks\": {}, \"alone_us\": {:.1f}, \"live_us\": {:.1f}, \"extra_us\": "
      "{:.1f}, "
      "\"ratio\": {:.3f}, \"link\": {}}}\n",
      transport, alone_us.size(), median(alone_us), median(live_us), median(extra_us),
      median(live_us) / median(alone_us), live.report().dump());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: live_bench TRANSPORT [SIMULATED_SECONDS]\n");
    return 2;
  }
  try {
    measure(argv[1], argc > 2 ? argv[2] : "20");
  } catch (const std::exception& error) {
    fmt::print(stderr, "live_bench: {}\n", error.what());
    return 1;
  }
  return 0;
}
