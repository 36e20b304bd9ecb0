#include "lab/trial/fall_observer.h"

#include <algorithm>
#include <cmath>

#include "sim_board/world/foot.h"

namespace koboshi::lab {

using behaviour::State;

void FallObserver::observe(const simulation::Simulation& simulation,
                           const simulation::RunRecorder& recorder) {
  if (is_foot_.empty()) begin(simulation);
  const sim_board::World& world = simulation.board().world();
  const double time_s = world.time_s();
  follow_state(recorder.telemetry().state, recorder.telemetry().reason, time_s);
  look_at_ground(world, time_s);
  if (history_.attempts > 0) look_at_servos(simulation.board());
  keep_parts(simulation.robot(), world);
}

void FallObserver::begin(const simulation::Simulation& simulation) {
  const sim_board::RobotDescription& robot = simulation.robot();
  is_foot_.assign(robot.links.size(), false);
  for (const auto& foot : sim_board::feet_of(robot)) {
    if (foot) is_foot_[static_cast<std::size_t>(foot->link)] = true;
  }
  parts_.push_back({.link = 0});
  if (const auto head = robot.find_link("head")) parts_.push_back({.link = *head});
  keep_parts(robot, simulation.board().world());
}

void FallObserver::follow_state(State state, behaviour::Reason reason, double time_s) {
  if (state == state_) return;
  if (state == State::kFalling) {
    ++history_.falls;
    if (!history_.predicted_s) history_.predicted_s = time_s;
  }
  if (state == State::kRighting && state_ == State::kFallen) ++history_.attempts;
  if (state == State::kStanding && state_ == State::kSteadying) ++history_.stands;
  const bool begins = state == State::kRolling || state == State::kRising;
  if (begins && history_.lay == behaviour::Reason::kNone) history_.lay = reason;
  state_ = state;
}

void FallObserver::look_at_ground(const sim_board::World& world, double time_s) {
  for (const sim_board::Contact& contact : world.contacts()) {
    if (contact.other_link >= 0 || is_foot_[static_cast<std::size_t>(contact.link)]) continue;
    if (!history_.touched_s) history_.touched_s = time_s;
    const auto part = std::ranges::find(parts_, contact.link, &Part::link);
    if (part == parts_.end() || history_.impact_m_per_s) continue;
    const Eigen::Vector3d v = part->v_WCom_W + part->w_WL_W.cross(contact.p_W - part->p_WCom_W);
    history_.impact_m_per_s = std::max(0.0, -v.dot(contact.n_W));
  }
}

void FallObserver::look_at_servos(const sim_board::SimBoard& board) {
  for (std::size_t joint = 0; joint < board.electronics().robot().joints.size(); ++joint) {
    const double torque_Nm = std::abs(board.world().joint(static_cast<int>(joint)).servo_Nm);
    history_.peak_torque_Nm = std::max(history_.peak_torque_Nm, torque_Nm);
    history_.peak_motor_torque_Nm =
        std::max(history_.peak_motor_torque_Nm, std::abs(board.electronics().drive(joint).torque_Nm()));
    history_.peak_winding_C = std::max(history_.peak_winding_C, board.electronics().drive(joint).winding_C());
  }
}

void FallObserver::keep_parts(const sim_board::RobotDescription& robot, const sim_board::World& world) {
  for (Part& part : parts_) {
    const sim_board::BodyState body = world.body(part.link);
    part.v_WCom_W = body.v_WCom_W;
    part.w_WL_W = body.w_WL_W;
    part.p_WCom_W = body.X_WL * robot.links[static_cast<std::size_t>(part.link)].p_LCom_L;
  }
}

}  // namespace koboshi::lab
