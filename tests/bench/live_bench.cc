// Measures the wall time of a live transport in a tick of 10 ms: two runs of the same walk side by side, tick
// by tick, one of them on the transport. Nobody waits for the clock. Beside them, a loop by which to compare
// machines and their load: as many datagrams through the kernel as a tick has frames. Prints one JSON
// document.
//
//   live_bench TRANSPORT [SIMULATED_SECONDS]

#include <fmt/core.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "hal/linux/file_descriptor.h"
#include "simulation/assembly/simulation.h"
#include "simulation/scenario/reader.h"
#include "tools/run/live_link.h"

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
  Walk(const simulation::Scenario& scenario, const std::string& transport)
      : link_(options(transport)), simulation_(scenario) {
    link_.attach(simulation_.board().electronics().bus());
  }

  double tick_us() {
    const auto start = Clock::now();
    for (std::uint64_t i = 0; i < sim_board::SimBoard::kTick_us / sim_board::SimBoard::kService_us; ++i) {
      link_.before(simulation_.board().now_us());
      simulation_.advance();
      link_.after(simulation_.board().now_us());
    }
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
  }
  bool finished() const { return simulation_.finished(); }
  nlohmann::ordered_json report() const { return link_.report(); }

 private:
  static tools::LiveOptions options(const std::string& transport) {
    if (transport == "none") return {};
    return {.can = transport, .speed = kNeverWaits};
  }

  tools::LiveLink link_;
  simulation::Simulation simulation_;
};

// The least that the kernel can be asked for each frame: to take it from one socket to another.
class Calibration {
 public:
  Calibration() {
    std::array<int, 2> ends{};
    hal::checked(::socketpair(AF_UNIX, SOCK_DGRAM, 0, ends.data()), "a pair of sockets");
    sender_ = hal::FileDescriptor(ends[0]);
    receiver_ = hal::FileDescriptor(ends[1]);
  }

  double tick_us() {
    const auto start = Clock::now();
    for (int i = 0; i < kFrames; ++i) {
      hal::checked(static_cast<int>(::send(sender_.number(), frame_.data(), frame_.size(), 0)), "send");
      hal::checked(static_cast<int>(::recv(receiver_.number(), frame_.data(), frame_.size(), 0)), "recv");
    }
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
  }

 private:
  static constexpr int kFrames = 48;  // of a tick of the walk

  hal::FileDescriptor sender_;
  hal::FileDescriptor receiver_;
  std::array<char, 16> frame_{};  // as large as Linux' can_frame
};

void measure(const std::string& transport, const std::string& seconds) {
  const std::vector<Override> overrides{{"physics.stepper", "lumped"}, {"duration_s", seconds}};
  const simulation::Scenario scenario =
      simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/walk.yaml", overrides);
  Walk alone(scenario, "none");
  Walk live(scenario, transport);
  Calibration calibration;
  std::vector<double> calibration_us;
  std::vector<double> alone_us;
  std::vector<double> live_us;
  std::vector<double> extra_us;
  while (!live.finished()) {
    calibration_us.push_back(calibration.tick_us());
    alone_us.push_back(alone.tick_us());
    live_us.push_back(live.tick_us());
    extra_us.push_back(live_us.back() - alone_us.back());
  }
  const double extra = median(extra_us);
  const double bare = median(calibration_us);
  const nlohmann::ordered_json json = {{"transport", transport},
                                       {"ticks", alone_us.size()},
                                       {"alone_us", median(alone_us)},
                                       {"live_us", median(live_us)},
                                       {"extra_us", extra},
                                       {"calibration_us", bare},
                                       {"extra_by_calibration", extra / bare},
                                       {"ratio", median(live_us) / median(alone_us)},
                                       {"link", live.report()}};
  fmt::print("{}\n", json.dump());
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
