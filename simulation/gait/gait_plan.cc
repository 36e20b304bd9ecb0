#include "simulation/gait/gait_plan.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace koboshi::simulation {
namespace {

using Eigen::Vector2d;
using hal::Side;

std::size_t index(Side side) { return static_cast<std::size_t>(side); }

// Returns position and velocity along one axis.
Vector2d along(const PendulumState& state, int axis) {
  return {state.position_m[axis], state.velocity_m_per_s[axis]};
}

// Returns the progress (0 to 1) of the swing sole at `phase`: a cycloid with zero speed at both ends, blended
// with constant speed by `profile`.
double swing_progress(double phase, double profile) {
  const double turn = 2.0 * std::numbers::pi * phase;
  return phase - profile * std::sin(turn) / (2.0 * std::numbers::pi);
}

double swing_height(double phase) { return 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * phase)); }

}  // namespace

GaitPlan::GaitPlan(const Gait& gait) : gait_(gait), pendulum_(gait.com_height_m) { plan(); }

GaitInstant GaitPlan::at(double time_s) const {
  if (time_s < start_s()) return instant(start_, std::max(time_s, 0.0));
  const double cycles = std::floor((time_s - start_s()) / cycle_s());
  GaitInstant now = instant(cycle_, time_s - start_s() - cycles * cycle_s());
  const double travel_m = cycles * stride_m();
  now.com_W_m.x() += travel_m;
  now.zmp_W_m.x() += travel_m;
  for (Eigen::Isometry3d& sole : now.X_WSole) sole.translation().x() += travel_m;
  return now;
}

GaitInstant GaitPlan::at_stop(double time_s) const { return instant(stop_, time_s); }

double GaitPlan::Stage::duration_s() const {
  double sum_s = 0.0;
  for (const ZmpPiece& piece : zmp) sum_s += piece.duration_s;
  return sum_s;
}

void GaitPlan::Stage::move_zmp(const Vector2d& by) {
  zmp[0].to_m += by;
  zmp[1].from_m += by;
  zmp[1].to_m += by;
  zmp[2].from_m += by;
}

double GaitPlan::duration_s(const std::vector<Stage>& stages) {
  double sum_s = 0.0;
  for (const Stage& stage : stages) sum_s += stage.duration_s();
  return sum_s;
}

Vector2d GaitPlan::zmp_of(Side side, const Vector2d& sole) const {
  const double inward_m = side == Side::kLeft ? -gait_.zmp_inward_m : gait_.zmp_inward_m;
  return sole + Vector2d(gait_.zmp_forward_m, inward_m);
}

Vector2d GaitPlan::middle_zmp(const Soles& soles) const {
  return 0.5 * (zmp_of(Side::kLeft, soles[0]) + zmp_of(Side::kRight, soles[1]));
}

// Returns a stage in which the ZMP leaves the middle between the feet and returns. `aim` sets the amplitude.
GaitPlan::Stage GaitPlan::shift(const Soles& soles) const {
  const Vector2d middle = middle_zmp(soles);
  const ZmpPiece piece{gait_.period_s / 3.0, middle, middle};
  return {.soles = soles, .swing = {}, .zmp = {piece, piece, piece}, .begin = {}};
}

GaitPlan::Stage GaitPlan::step(const Soles& soles, Side swing, double length_m) const {
  const Side support = other(swing);
  const Vector2d stand = soles[index(support)];
  const double y_m = soles[index(swing)].y();
  const Vector2d landing(stand.x() + length_m, y_m);
  const double step_s = 0.5 * gait_.period_s;
  const double half_double_s = 0.5 * gait_.double_support * step_s;
  const Vector2d rest = zmp_of(support, stand);
  Soles landed = soles;
  landed[index(swing)] = landing;
  return {.soles = soles,
          .swing = swing,
          .landing = landing,
          .zmp = {ZmpPiece{half_double_s, middle_zmp(soles), rest},
                  ZmpPiece{step_s - 2.0 * half_double_s, rest, rest},
                  ZmpPiece{half_double_s, rest, middle_zmp(landed)}},
          .begin = {}};
}

// Adds a step for each of `shares` of the full step length. Returns the final positions of the soles.
GaitPlan::Soles GaitPlan::add_steps(std::vector<Stage>& stages, Soles soles, Side swing,
                                    const std::vector<double>& shares) const {
  for (const double share : shares) {
    stages.push_back(step(soles, swing, share * gait_.step_length_m));
    soles[index(swing)] = stages.back().landing;
    swing = other(swing);
  }
  return soles;
}

void GaitPlan::plan() {
  std::vector<double> growing;
  for (int i = 1; i <= gait_.start_steps; ++i) growing.push_back(i / double(gait_.start_steps + 1));
  std::vector<double> shrinking(growing.rbegin(), growing.rend());
  growing.push_back(1.0);
  shrinking.push_back(0.0);

  Soles soles{Vector2d(0.0, 0.5 * gait_.step_width_m), Vector2d(0.0, -0.5 * gait_.step_width_m)};
  start_.push_back(shift(soles));
  soles = add_steps(start_, soles, Side::kLeft, growing);
  const Side first = other(*start_.back().swing);
  add_steps(cycle_, soles, first, {1.0, 1.0});
  soles = add_steps(stop_, soles, first, shrinking);  // in the coordinates of the cycle's beginning
  stop_.push_back(shift(soles));

  enter(cycle_, periodic_state());
  const auto standing = [&](const Stage& stage) {
    return PendulumState{middle_zmp(stage.soles), Vector2d::Zero()};
  };
  aim(start_, {&start_.front(), &start_.back()}, standing(start_.front()), cycle_.front().begin);
  aim(stop_, {&stop_.front(), &stop_.back()}, cycle_.front().begin, standing(stop_.back()));
}

// Returns the initial state that two steps shift by exactly one stride. The condition is linear; its matrix
// follows from propagating unit states.
PendulumState GaitPlan::periodic_state() const {
  const PendulumState offset = pass(cycle_, {});
  const PendulumState by_position = pass(cycle_, {Vector2d::Ones(), Vector2d::Zero()});
  const PendulumState by_velocity = pass(cycle_, {Vector2d::Zero(), Vector2d::Ones()});
  PendulumState state;
  for (int axis = 0; axis < 2; ++axis) {
    Eigen::Matrix2d A;
    A.col(0) = along(by_position, axis) - along(offset, axis);
    A.col(1) = along(by_velocity, axis) - along(offset, axis);
    const Vector2d way(axis == 0 ? stride_m() : 0.0, 0.0);
    const Vector2d begin = (A - Eigen::Matrix2d::Identity()).fullPivLu().solve(way - along(offset, axis));
    state.position_m[axis] = begin[0];
    state.velocity_m_per_s[axis] = begin[1];
  }
  return state;
}

PendulumState GaitPlan::pass(const Stage& stage, const PendulumState& begin) const {
  PendulumState state = begin;
  for (const ZmpPiece& piece : stage.zmp) state = pendulum_.advance(state, piece, piece.duration_s);
  return state;
}

PendulumState GaitPlan::pass(const std::vector<Stage>& stages, PendulumState state) const {
  for (const Stage& stage : stages) state = pass(stage, state);
  return state;
}

void GaitPlan::enter(std::vector<Stage>& stages, PendulumState state) const {
  for (Stage& stage : stages) {
    stage.begin = state;
    state = pass(stage, state);
  }
}

// Shifts the ZMP of two stages such that the stages lead from `begin` to `end`.
void GaitPlan::aim(std::vector<Stage>& stages, const std::array<Stage*, 2>& movable,
                   const PendulumState& begin, const PendulumState& end) const {
  const PendulumState missed = pass(stages, begin);
  std::array<PendulumState, 2> moved;
  for (std::size_t i = 0; i < 2; ++i) {
    movable[i]->move_zmp(Vector2d::Ones());
    moved[i] = pass(stages, begin);
    movable[i]->move_zmp(-Vector2d::Ones());
  }
  std::array<Vector2d, 2> by;
  for (int axis = 0; axis < 2; ++axis) {
    Eigen::Matrix2d A;
    for (int i = 0; i < 2; ++i)
      A.col(i) = along(moved[static_cast<std::size_t>(i)], axis) - along(missed, axis);
    const Vector2d way = A.fullPivLu().solve(along(end, axis) - along(missed, axis));
    for (int i = 0; i < 2; ++i) by[static_cast<std::size_t>(i)][axis] = way[i];
  }
  for (std::size_t i = 0; i < 2; ++i) movable[i]->move_zmp(by[i]);
  enter(stages, begin);
}

GaitInstant GaitPlan::instant(const std::vector<Stage>& stages, double time_s) const {
  auto stage = stages.begin();
  while (stage + 1 != stages.end() && time_s >= stage->duration_s()) {
    time_s -= stage->duration_s();
    ++stage;
  }
  time_s = std::min(time_s, stage->duration_s());

  GaitInstant now;
  Soles soles = stage->soles;
  double height_m = 0.0;
  if (stage->swing) {
    const double airborne_s = stage->zmp[1].duration_s;
    const double phase = std::clamp((time_s - stage->zmp[0].duration_s) / airborne_s, 0.0, 1.0);
    Vector2d& sole = soles[index(*stage->swing)];
    sole += swing_progress(phase, gait_.swing_profile) * (stage->landing - sole);
    height_m = gait_.step_height_m * swing_height(phase);
  }
  for (const Side side : {Side::kLeft, Side::kRight}) {
    const bool swings = stage->swing == side;
    now.X_WSole[index(side)].translation() << soles[index(side)], swings ? height_m : 0.0;
  }

  PendulumState state = stage->begin;
  double left_s = time_s;
  auto piece = stage->zmp.begin();
  for (; piece + 1 != stage->zmp.end() && left_s >= piece->duration_s; ++piece) {
    state = pendulum_.advance(state, *piece, piece->duration_s);
    left_s -= piece->duration_s;
  }
  now.com_W_m = pendulum_.advance(state, *piece, left_s).position_m;
  now.zmp_W_m = piece->at(left_s);

  const Vector2d left_zmp = zmp_of(Side::kLeft, soles[0]);
  const Vector2d right_zmp = zmp_of(Side::kRight, soles[1]);
  double share = std::clamp((now.zmp_W_m.y() - right_zmp.y()) / (left_zmp.y() - right_zmp.y()), 0.0, 1.0);
  if (height_m > 0.0) share = *stage->swing == Side::kLeft ? 0.0 : 1.0;
  now.load_share = {share, 1.0 - share};
  now.support = share >= 0.5 ? Side::kLeft : Side::kRight;
  now.zmp_S_m = now.zmp_W_m - soles[index(now.support)];
  return now;
}

}  // namespace koboshi::simulation
