#include "tools/teleop/teleop.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <variant>

#include "simulation/assembly/parameters.h"
#include "simulation/observe/posture.h"
#include "simulation/observe/run_recorder.h"

namespace koboshi::tools {
namespace {

constexpr std::chrono::milliseconds kDrawing{100};
constexpr double kPaceWindow_s = 1.0;
constexpr double kVelocityWindow_s = 1.0;  // about two gait cycles, to average the sway of the trunk

TeleopStatus::Velocity as_velocity(const std::array<double, 3>& rates) {
  return {rates[0], rates[1], rates[2]};
}

}  // namespace

Teleop::Teleop(simulation::Simulation& simulation, const simulation::RunRecorder& recorder,
               const LiveLink& live, const Seats& seats)
    : simulation_(simulation),
      recorder_(recorder),
      live_(live),
      seats_(seats),
      pilot_(simulation::controller_values(simulation.scenario()).velocity_limits),
      pace_(kPaceWindow_s),
      velocity_(kVelocityWindow_s) {
  if (seats.terminal) terminal_.emplace();
}

bool Teleop::tick() {
  if (terminal_) {
    for (const char byte : terminal_->read()) {
      const auto key = decoder_.take(byte);
      if (key && !obey(*key)) return false;
    }
  }
  if (seats_.page_keys != nullptr) {
    while (const auto key = seats_.page_keys->pop()) {
      if (!obey(*key)) return false;
    }
  }
  if (seats_.view != nullptr) tell_page();
  if (!terminal_) return true;
  measure();
  if (Clock::now() >= next_drawing_) {
    next_drawing_ = Clock::now() + kDrawing;
    terminal_->show(status_lines(status()));
  }
  return !terminal_->closed();
}

// Tells the effect of the last key and the controller's answer.
void Teleop::tell_page() {
  std::string note;
  if (!last_key_.empty()) note = "key " + last_key_ + ": " + pilot_.effect();
  const std::string& command = recorder_.events().last_command();
  if (!command.empty()) note += (note.empty() ? "" : "\n") + ("command " + command);
  if (note == told_) return;
  told_ = note;
  seats_.view->tell(std::move(note));
}

bool Teleop::obey(Key key) {
  last_key_ = name_of(key);
  const Order order = pilot_.press(key, recorder_.telemetry().state);
  if (const auto* command = std::get_if<simulation::Command>(&order)) simulation_.command(*command);
  if (const auto* push = std::get_if<BodyPush>(&order)) {
    simulation_.push(push->on(simulation_.robot().links.front().name, recorder_.truth().rpy_rad.z()));
  }
  return !std::holds_alternative<EndOfRun>(order);
}

void Teleop::measure() {
  const simulation::GroundTruth& truth = recorder_.truth();
  const Eigen::Vector3d place(truth.p_WB_W.x(), truth.p_WB_W.y(), truth.rpy_rad.z());
  if (place_) {
    const Eigen::Vector3d moved = place - *place_;
    const Eigen::Vector2d moved_B = Eigen::Rotation2Dd(-place.z()) * moved.head<2>();
    distance_[0] += moved_B.x();
    distance_[1] += moved_B.y();
    distance_[2] += std::remainder(moved.z(), 2.0 * std::numbers::pi);
  }
  place_ = place;
  map_.move_to(place);
  velocity_.add(now_s(), distance_);
  pace_.add(std::chrono::duration<double>(Clock::now() - start_).count(), {now_s()});
}

TeleopStatus Teleop::status() const {
  const sim_board::SimBoard& board = simulation_.board();
  const simulation::Scenario& scenario = simulation_.scenario();
  TeleopStatus status;
  status.scenario = scenario.file.filename().string();
  if (live_.transport() != nullptr) status.bus = live_.transport()->place();
  if (seats_.view != nullptr) status.page = seats_.view->address();
  status.simulated_s = now_s();
  status.real_time_factor = pace_.per_s()[0];
  if (const Pacer* pacer = live_.pacer()) {
    status.overruns = pacer->overruns();
    status.largest_delay_us = pacer->largest_delay_us();
  }
  status.held = scenario.initial.fixed_base &&
                board.now_us() < scenario.initial.release_us.value_or(board.now_us() + 1);
  status.falls = recorder_.events().falls();
  status.tilt_rad = recorder_.truth().tilt_rad;
  status.said = recorder_.telemetry();
  const walk::Velocity& commanded = pilot_.velocity();
  status.commanded = {1e-3 * commanded.forward_mm_per_s, 1e-3 * commanded.left_mm_per_s,
                      1e-3 * commanded.turn_mrad_per_s};
  status.measured = as_velocity(velocity_.per_s());
  status.place = *place_;
  status.zmp_margin_m = recorder_.truth().zmp_margin_m;
  for (std::size_t joint = 0; joint < simulation_.robot().joints.size(); ++joint) {
    const double supply_V = 1e-3 * board.electronics().drive(joint).values().supply_mV;
    status.supply_V = std::min(supply_V, status.supply_V.value_or(supply_V));
  }
  status.push_N_s = pilot_.push_N_s();
  status.aims = pilot_.aims();
  status.last_key = last_key_;
  status.effect = pilot_.effect();
  status.last_command = recorder_.events().last_command();
  status.last_event = recorder_.events().last_text();
  status.map = map_.lines(status.tilt_rad > simulation::kFallen_rad);
  return status;
}

}  // namespace koboshi::tools
