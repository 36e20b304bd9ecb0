#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <string>

#include "tools/run/run.h"
#include "tools/teleop/key_queue.h"
#include "tools/teleop/map.h"
#include "tools/teleop/pilot.h"
#include "tools/teleop/sliding_rate.h"
#include "tools/teleop/status.h"
#include "tools/teleop/terminal.h"
#include "view/live/live_view.h"

namespace koboshi::tools {

// An operator at the keyboard of this terminal, at a page of the live view, or at both. Keys become commands
// on the simulated bus, sent by the PC that also sends the scenario's, and pushes of the base link. The
// terminal's screen shows the state of the robot.
class Teleop final : public RunOperator {
 public:
  struct Seats {
    bool terminal = true;
    // The page of the run and its keys; both may be null.
    view::LiveView* view = nullptr;
    KeyQueue* page_keys = nullptr;
  };

  // Holds the terminal as long as it lives. Throws what Terminal and controller_values throw.
  Teleop(simulation::Simulation& simulation, const simulation::RunRecorder& recorder, const LiveLink& live,
         const Seats& seats);

  bool tick() override;

 private:
  using Clock = std::chrono::steady_clock;

  // Returns false if the key ends the run.
  bool obey(Key key);
  void tell_page();
  void measure();
  double now_s() const { return 1e-6 * static_cast<double>(simulation_.board().now_us()); }
  TeleopStatus status() const;

  simulation::Simulation& simulation_;
  const simulation::RunRecorder& recorder_;
  const LiveLink& live_;
  const Seats seats_;
  Pilot pilot_;
  KeyDecoder decoder_;
  std::string last_key_;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point next_drawing_ = start_;
  SlidingRate<1> pace_;
  SlidingRate<3> velocity_;
  // Distance walked forward and to the left [m] and angle turned [rad], in the heading of each tick.
  std::array<double, 3> distance_{};
  std::optional<Eigen::Vector3d> place_;  // x, y and yaw in the world
  TrailMap map_;
  std::string told_;  // to the pages
  std::optional<Terminal> terminal_;
};

}  // namespace koboshi::tools
