#include "tools/motion/check/analysis.h"

#include <algorithm>
#include <cmath>

#include "sim_board/world/gravity.h"
#include "tools/motion/check/servo_curve.h"

namespace koboshi::tools {
namespace {

// The tail of the response that is cut off, in units of the time constant: exp(-7) (1 + 7) < 0.8 %.
constexpr double kResponseLength = 7.0;

// Mean over each tick of w^2 t exp(-w t), the impulse response of a critically damped oscillator.
std::vector<double> impulse_response(double natural_rad_per_s) {
  const auto step_response = [&](double time_s) {
    const double phase = natural_rad_per_s * time_s;
    return 1.0 - (1.0 + phase) * std::exp(-phase);
  };
  const auto ticks = static_cast<std::size_t>(std::ceil(kResponseLength / (natural_rad_per_s * kTick_s)));
  std::vector<double> response;
  double sum = 0.0;
  for (std::size_t i = 0; i < std::max<std::size_t>(ticks, 1); ++i) {
    const double begin_s = static_cast<double>(i) * kTick_s;
    response.push_back(step_response(begin_s + kTick_s) - step_response(begin_s));
    sum += response.back();
  }
  for (double& value : response) value /= sum;
  return response;
}

std::size_t mean_delay(const std::vector<double>& response) {
  double mean = 0.0;
  for (std::size_t i = 0; i < response.size(); ++i) mean += static_cast<double>(i) * response[i];
  return static_cast<std::size_t>(std::lround(mean));
}

}  // namespace

MotionAnalysis::MotionAnalysis(const sim::RobotDescription& robot, const Supply& supply)
    : robot_(robot), supply_(supply), body_(robot), pairs_(robot, body_) {
  for (const sim::JointDescription& joint : robot.joints)
    stiffness_Nm_.push_back(stiffness_Nm_per_rad(joint.servo, supply.nominal_V));
  double ankles_Nm = 0.0;
  for (const auto* const ankle : {&robot.left_ankle, &robot.right_ankle})
    ankles_Nm += stiffness_Nm_[static_cast<std::size_t>(ankle->value().joint)];
  const double inertia_kg_m2 = body_.mass_kg() * body_.com_height_m() * body_.com_height_m();
  natural_rad_per_s_ = std::sqrt(ankles_Nm / inertia_kg_m2);
  response_ = impulse_response(natural_rad_per_s_);
  shift_ = mean_delay(response_);
  angles_.resize(robot.joints.size());
  speeds_.resize(robot.joints.size());
  accelerations_.resize(robot.joints.size());
}

void MotionAnalysis::smooth(const Trajectory& trajectory, std::size_t first, std::size_t last) {
  const std::size_t joints = trajectory.joints;
  const auto last_tick = static_cast<std::ptrdiff_t>(trajectory.ticks()) - 1;
  for (std::size_t tick = first; tick <= last; ++tick) {
    const std::span<double> row = std::span(smoothed_).subspan(tick * joints, joints);
    std::ranges::fill(row, 0.0);
    for (std::size_t i = 0; i < response_.size(); ++i) {
      const std::ptrdiff_t from = std::clamp<std::ptrdiff_t>(
          static_cast<std::ptrdiff_t>(tick + shift_) - static_cast<std::ptrdiff_t>(i), 0, last_tick);
      const std::span<const double> targets = trajectory.row(static_cast<std::size_t>(from));
      for (std::size_t j = 0; j < joints; ++j) row[j] += response_[i] * targets[j];
    }
  }
}

JointShare MotionAnalysis::torque_share(const Stance& stance) {
  JointShare worst;
  for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
    const double share =
        tools::torque_share(robot_.joints[j].servo, stance.torques_Nm[j], speeds_[j], supply_.lowest_V);
    if (share > worst.share) worst = {static_cast<std::uint8_t>(j), share};
  }
  return worst;
}

TickState MotionAnalysis::compute(const Trajectory& trajectory, std::size_t tick) {
  const std::size_t joints = trajectory.joints;
  const std::size_t before = tick == 0 ? 0 : tick - 1;
  const std::size_t after = std::min(tick + 1, trajectory.ticks() - 1);
  const double* const past = smoothed_.data() + before * joints;
  const double* const now = smoothed_.data() + tick * joints;
  const double* const next = smoothed_.data() + after * joints;
  for (std::size_t j = 0; j < joints; ++j) {
    angles_[j] = now[j];
    speeds_[j] = (next[j] - past[j]) / (2.0 * kTick_s);
    accelerations_[j] = (next[j] - 2.0 * now[j] + past[j]) / (kTick_s * kTick_s);
  }
  TickState state;
  if (trajectory.on_feet[tick]) {
    // The servos yield to the static load: a proportional position loop has a position error.
    body_.solve_at_rest(angles_, stance_);
    for (std::size_t j = 0; j < joints; ++j) angles_[j] -= stance_.torques_Nm[j] / stiffness_Nm_[j];
    body_.solve(angles_, speeds_, accelerations_, stance_);
    const std::vector<Eigen::Vector2d> polygon = body_.support_polygon(stance_);
    state.up_B = stance_.rest.up_B;
    state.zmp_m = stance_.zmp_m;
    state.com_m = stance_.com_m;
    state.zmp = margin_in(polygon, stance_.zmp_m);
    state.com = margin_in(polygon, stance_.com_m);
    state.pitch_rad = std::asin(std::clamp(-state.up_B.x(), -1.0, 1.0));
    state.roll_rad = std::atan2(state.up_B.y(), state.up_B.z());
    state.tip_rad = stance_.rest.tip_rad;
    state.drop_m = stance_.rest.drop_m;
    state.com_height_m = stance_.com_height_m;
    state.rests = stance_.rest.rests;
    state.load_share = stance_.load_share;
    state.corners = stance_.rest.corners;
    state.torque = torque_share(stance_);
  }
  body_.place(trajectory.row(tick), places_);
  state.overlap = pairs_.deepest(places_);
  return state;
}

const std::vector<TickState>& MotionAnalysis::analyse(const Trajectory& trajectory) {
  const std::size_t ticks = trajectory.ticks();
  const std::size_t joints = trajectory.joints;
  const std::size_t old_ticks = states_.size();
  // Rows that begin and end both trajectories alike.
  const auto equal_rows = [&](std::size_t tick, std::size_t old_tick) {
    const auto row = trajectory.row(tick);
    return std::equal(row.begin(), row.end(),
                      targets_rad_.begin() + static_cast<std::ptrdiff_t>(old_tick * joints));
  };
  const std::size_t common = std::min(ticks, old_ticks);
  std::size_t prefix = 0;
  while (prefix < common && equal_rows(prefix, prefix) && trajectory.on_feet[prefix] == on_feet_[prefix])
    ++prefix;
  std::size_t suffix = 0;
  while (suffix < common - prefix && equal_rows(ticks - 1 - suffix, old_ticks - 1 - suffix) &&
         trajectory.on_feet[ticks - 1 - suffix] == on_feet_[old_ticks - 1 - suffix])
    ++suffix;
  // A state reads smoothed rows one tick around it, a smoothed row targets from response - shift ticks before
  // to shift ticks after.
  const bool unchanged = prefix == ticks && ticks == old_ticks;
  const std::size_t reads_after = shift_ + 1;
  const std::size_t reads_before = response_.size() - shift_;
  const std::size_t first = unchanged ? ticks : prefix > reads_after ? prefix - reads_after : 0;
  const std::size_t last = suffix > reads_before ? ticks - (suffix - reads_before) : ticks;  // one past
  std::vector<TickState> states(ticks);
  std::copy_n(states_.begin(), first, states.begin());
  if (last < ticks)
    std::copy_n(states_.end() - static_cast<std::ptrdiff_t>(ticks - last), ticks - last,
                states.begin() + static_cast<std::ptrdiff_t>(last));
  computed_ = 0;
  if (first < last) {
    smoothed_.resize(ticks * joints);
    smooth(trajectory, first == 0 ? 0 : first - 1, std::min(last, ticks - 1));
    for (std::size_t tick = first; tick < last; ++tick) states[tick] = compute(trajectory, tick);
    computed_ = last - first;
  }
  states_ = std::move(states);
  targets_rad_ = trajectory.targets_rad;
  on_feet_ = trajectory.on_feet;
  return states_;
}

}  // namespace koboshi::tools
