#include "tools/motion_check/analysis.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "sim_board/world/gravity.h"
#include "tools/motion_check/hash.h"
#include "tools/motion_check/servo_curve.h"

namespace koboshi::tools {
namespace {

// The tail of the response that is cut off, in units of the time constant: exp(-7) (1 + 7) < 0.8 %.
constexpr double kResponseLength = 7.0;

// A multiplier of 64-bit congruential generators (Steele and Vigna 2021).
constexpr std::uint64_t kHashFactor = 0xD1342543DE82EF95U;

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

MotionAnalysis::MotionAnalysis(const sim_board::RobotDescription& robot, const Supply& supply)
    : robot_(robot),
      supply_(supply),
      body_(robot),
      pairs_(robot),
      extremes_(robot, body_, pairs_, stiffness_Nm_) {
  for (const sim_board::JointDescription& joint : robot.joints)
    stiffness_Nm_.push_back(stiffness_Nm_per_rad(joint.servo, supply.nominal_V));
  double ankles_Nm = 0.0;
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight})
    ankles_Nm += stiffness_Nm_[static_cast<std::size_t>(robot.foot_joint(side).value())];
  const double inertia_kg_m2 = body_.mass_kg() * body_.com_height_m() * body_.com_height_m();
  natural_rad_per_s_ = std::sqrt(ankles_Nm / inertia_kg_m2);
  response_ = impulse_response(natural_rad_per_s_);
  shift_ = mean_delay(response_);
  angles_.resize(robot.joints.size());
  speeds_.resize(robot.joints.size());
  accelerations_.resize(robot.joints.size());
}

void MotionAnalysis::smooth(const Trajectory& trajectory, std::size_t tick) {
  if (is_smoothed_[tick]) return;
  is_smoothed_[tick] = true;
  const std::size_t joints = trajectory.joints;
  const auto last_tick = static_cast<std::ptrdiff_t>(trajectory.ticks()) - 1;
  const std::span<double> row = std::span(smoothed_).subspan(tick * joints, joints);
  std::ranges::fill(row, 0.0);
  for (std::size_t i = 0; i < response_.size(); ++i) {
    const std::ptrdiff_t from = std::clamp<std::ptrdiff_t>(
        static_cast<std::ptrdiff_t>(tick + shift_) - static_cast<std::ptrdiff_t>(i), 0, last_tick);
    const std::span<const double> targets = trajectory.row(static_cast<std::size_t>(from));
    for (std::size_t j = 0; j < joints; ++j) row[j] += response_[i] * targets[j];
  }
}

// Hashes by tick what its state depends on. A state reads smoothed rows one tick around it, a smoothed row
// targets from response - shift ticks before to shift ticks after.
std::vector<std::uint64_t> MotionAnalysis::windows(const Trajectory& trajectory) const {
  const std::size_t ticks = trajectory.ticks();
  std::vector<std::uint64_t> rows(ticks, kHashSeed);
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    for (const double target_rad : trajectory.row(tick))
      add_to_hash(rows[tick], std::bit_cast<std::uint64_t>(target_rad));
    for (const double gain : trajectory.gain_sets[trajectory.gains[tick]])
      add_to_hash(rows[tick], std::bit_cast<std::uint64_t>(gain));
  }
  const auto before = static_cast<std::ptrdiff_t>(response_.size() - shift_);
  const auto after = static_cast<std::ptrdiff_t>(shift_ + 1);
  const auto last = static_cast<std::ptrdiff_t>(ticks) - 1;
  const auto row = [&](std::ptrdiff_t tick) {
    return rows[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(tick, 0, last))];
  };
  // A window is a polynomial of its rows, modulo 2^64, so that the next one follows from it (Karp and Rabin
  // 1987). The rows are well mixed, which the modulus requires.
  std::uint64_t window = 0;
  std::uint64_t oldest_factor = 1;
  for (std::ptrdiff_t i = -before; i <= after; ++i) {
    window = window * kHashFactor + row(i);
    if (i < after) oldest_factor *= kHashFactor;
  }
  std::vector<std::uint64_t> result(ticks, kHashSeed);
  for (std::ptrdiff_t tick = 0; tick <= last; ++tick) {
    std::uint64_t& hash = result[static_cast<std::size_t>(tick)];
    add_to_hash(hash, window);
    // Rates are one-sided at the ends.
    add_to_hash(hash, (trajectory.on_feet[static_cast<std::size_t>(tick)] ? 1U : 0U) | (tick == 0 ? 2U : 0U) |
                          (tick == last ? 4U : 0U));
    window = (window - row(tick - before) * oldest_factor) * kHashFactor + row(tick + after + 1);
  }
  return result;
}

void MotionAnalysis::add_torques(const Stance& stance, TickState& state) const {
  auto loads = std::make_shared<std::vector<ServoLoad>>();
  loads->reserve(robot_.joints.size());
  for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
    const sim_board::ServoDescription& servo = robot_.joints[j].servo;
    loads->push_back(servo_load(servo, stance.torques_Nm[j], speeds_[j], supply_.lowest_V));
    const double share = torque_share(servo, stance.torques_Nm[j], speeds_[j], supply_.lowest_V);
    if (share > state.torque.share) state.torque = {static_cast<std::uint8_t>(j), share};
  }
  state.loads = std::move(loads);
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
    for (std::size_t j = 0; j < joints; ++j)
      angles_[j] -= stance_.torques_Nm[j] / (stiffness_Nm_[j] * trajectory.gain(tick, j));
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
    add_torques(stance_, state);
  }
  body_.place(trajectory.row(tick), X_BLs_);
  state.overlap = pairs_.deepest(X_BLs_);
  return state;
}

const std::vector<TickState>& MotionAnalysis::analyse(const Trajectory& trajectory,
                                                      const std::stop_token& cancel) {
  const std::size_t ticks = trajectory.ticks();
  const std::vector<std::uint64_t> keys = windows(trajectory);
  mix_extremes_ = extremes_.evaluate(trajectory, keys, cancel);
  smoothed_.resize(ticks * trajectory.joints);
  is_smoothed_.assign(ticks, false);
  states_.resize(ticks);
  computed_ = 0;
  for (std::size_t tick = 0; tick < ticks && !cancel.stop_requested(); ++tick) {
    const auto [known, is_new] = known_.try_emplace(keys[tick]);
    if (is_new) {
      for (std::size_t i = tick == 0 ? 0 : tick - 1; i <= std::min(tick + 1, ticks - 1); ++i)
        smooth(trajectory, i);
      known->second.state = compute(trajectory, tick);
      ++computed_;
    }
    known->second.used = time_;
    states_[tick] = known->second.state;
  }
  return states_;
}

void MotionAnalysis::forget_unused() {
  std::erase_if(known_, [&](const auto& known) { return known.second.used < time_; });
  ++time_;
  extremes_.forget_unused();
}

}  // namespace koboshi::tools
