#include "firmware/robot/leg_newton.h"

#include <algorithm>
#include <array>

#include "firmware/fixed/literals.h"
#include "firmware/fixed/radians.h"
#include "firmware/fixed/rounding.h"
#include "firmware/fixed/saturating.h"
#include "firmware/fixed/trigonometry.h"

namespace koboshi::robot {
namespace {

using fixed::Angle;
using fixed::Length;
using fixed::Ratio;
using namespace fixed::literals;

// lambda^2, in squares of Ratio's LSB: 2^-20. By hand, 2026-11-26: a hundred times the rounding of the
// factorisation, and an eighth of the square of the smallest singular value at kMinBend.
constexpr std::int64_t kDamping_raw = std::int64_t{1} << 40;
// Fraction bits of the inverse roots of the pivots, 0.7 to 1 / lambda = 2^10: to 2^-20 of the root itself.
constexpr int kRootBits = 20;
// Least pivot of a leg that moves its sole in all directions, 2^-13: a singular value of 0.011. By hand,
// 2026-11-26: the default robot has 0.006 = 50 times as much.
constexpr std::int64_t kMinPivot_raw = std::int64_t{1} << 47;
// Least bend of the knee: 1 degree costs 5 um of reach at 65 mm of thigh and shank.
constexpr Angle kMinBend = 1.0_deg;
constexpr Ratio kCosineOfMinBend = 0.99984769515639_ratio;
// From this bend on, and for changes of up to this size in rad, the change itself is as good as that of its
// cosine, and saves a root and two divisions: the two differ by at most kSmallBend^2 / (2 tan kWellBent) =
// 3.4e-4 rad, which the next step squares.
constexpr Angle kWellBent = 20.0_deg;
constexpr Ratio kSmallBend = Ratio::from_raw(1 << 24);
// The bend from which the first solution begins. By hand, 2026-11-26: between standing and a deep squat.
constexpr Angle kSeedBend = 40.0_deg;
// Limit of a joint's change in one step, in rad: half of the change for which a rotation is nearly linear.
constexpr Ratio kMaxStep = 0.5_ratio;
// Clamp of the error's components in units of the scale and of a sine.
constexpr Ratio kMaxError = 0.5_ratio;
// A target farther from the last solution has jumped: a quarter of a radian, and as many units of the scale,
// is ten times what a swing foot moves in a cycle.
constexpr Ratio kJump = 0.25_ratio;
// Error that the next Newton step squares below the tolerances: 1/256 of the scale and of a radian.
constexpr Ratio kNear = Ratio::from_raw(1 << 22);
// Error that one Newton step takes to 6 um at 0.25 m: a step from 0.41 mm = 1/610 of the scale leaves 6 times
// its square. With a predicted `last`, three of four cycles of a walk begin within it.
constexpr Ratio kWithinOneStep = Ratio::from_raw(1 << 21);
// A rotation, in rad, and a displacement, in units of the scale: a column of the Jacobian, or the error.
struct Twist {
  Direction turn;
  Direction move;
};

std::int64_t sum_of_products_raw(const Direction& p, const Direction& q) {
  return std::int64_t{p.x.raw()} * q.x.raw() + std::int64_t{p.y.raw()} * q.y.raw() +
         std::int64_t{p.z.raw()} * q.z.raw();
}

// The squares of the two parts of a column are at most 1 each, and those of the error at most 1 and 3/4.
std::int64_t inner_product_raw(const Twist& a, const Twist& b) {
  return sum_of_products_raw(a.turn, b.turn) + sum_of_products_raw(a.move, b.move);
}

bool is_within(const Direction& v, Ratio limit) {
  return fixed::abs(v.x) <= limit && fixed::abs(v.y) <= limit && fixed::abs(v.z) <= limit;
}

bool is_within(const Position& p, Length limit) {
  return fixed::abs(p.x) <= limit && fixed::abs(p.y) <= limit && fixed::abs(p.z) <= limit;
}

Angle signed_by(std::int8_t sign, Angle angle) { return sign < 0 ? -angle : angle; }

class NewtonLeg {
 public:
  NewtonLeg(const RobotModel& model, const LegGeometry& leg, const Pose& X_BSole, Angle yaw)
      : model_(model),
        leg_(leg),
        unknowns_(leg.joint_count - (leg.shares_yaw ? 1 : 0)),
        given_(leg.shares_yaw ? place_of_yaw(leg) : kLegJoints),
        yaw_(yaw),
        shift_(Ratio::kFractionBits - Length::kFractionBits - leg.scale),
        R_target_(X_BSole.R) {
    pull_in(X_BSole.p);
  }

  LegAngles solve(const LegAngles* last, FirstSolution first) {
    const bool in_parts = first == FirstSolution::kInParts;
    if (last != nullptr)
      result_.angles = last->angles;
    else
      bend_knee();
    const bool is_followed = (last != nullptr || in_parts) && follow(in_parts);
    if (!is_followed) start();
    if (leg_.shares_yaw) result_.angles[kHipYaw] = yaw_;
    if (!leg_.can_turn()) measure_heading();
    return result_;
  }

  std::int64_t least_pivot_raw() {
    bend_knee();
    look();
    return factorise();
  }

 private:
  // Takes the steps of a cycle from the last solution; false if the target has jumped, unless it may be
  // `far`. The pose after the
  // last step is not computed: it counts as reached where the pose before it was near and no limit stopped a
  // joint.
  bool follow(bool far) {
    for (int i = 0; i < kTrackingSteps; ++i) {
      look();
      if (i == 0 && !far && !(is_within(error_.move, kJump) && is_within(error_.turn, kJump))) return false;
      step();
      if (is_within(error_.move, kWithinOneStep) && is_within(error_.turn, kWithinOneStep)) break;
    }
    result_.reached = !stopped_ && is_within(error_.move, kNear) && is_within(error_.turn, kNear);
    return true;
  }

  void start() {
    bend_knee();
    for (int i = 0; i < kMaxFirstSteps; ++i) {
      look();
      if (is_reached()) break;
      step();
    }
    look();
    result_.reached = is_reached();
  }

  // Moves a target beyond the extent of the leg there, so that every difference stays in range and the leg
  // points at the target.
  void pull_in(const Position& p_BSole) {
    constexpr Length kMax = Length::from_raw(1 << 27);  // 8 m, whose squares fit
    const auto within_8_m = [&](Length length) { return std::clamp(length, -kMax, kMax); };
    Position r = p_BSole - joint(leg_.chain_joints[0]).anchor;
    if (!is_within(r, leg_.extent)) {
      r = Position{within_8_m(r.x), within_8_m(r.y), within_8_m(r.z)};
      const Length distance = fixed::hypotenuse(r.x, r.y, r.z);
      const auto pulled = [&](Length length) {
        return fixed::mul_div(length, leg_.extent.raw(), distance.raw());
      };
      r = {pulled(r.x), pulled(r.y), pulled(r.z)};
    }
    target_ = scaled(r);
  }

  // Bends the knee, and hip and ankle by half of that in the other direction each.
  void bend_knee() {
    const Angle change = kSeedBend - bend_at_zero();
    for (const LegJoint i : leg_.chain()) {
      const Angle about_y = i == kKnee                           ? change
                            : i == kHipPitch || i == kAnklePitch ? -(change / 2)
                                                                 : Angle();
      result_.angles[i] = clamp_to_limits(joint(i), signed_by(leg_.signs[i], about_y));
    }
  }

  // Computes the chain of the present angles, its Jacobian and the error. Lengths are in units of the scale.
  void look() {
    const LegJoint first = leg_.chain_joints[0];
    Direction p;  // from the first anchor
    Rotation R = rotation_about(joint(first).axis, hinge_angle(first));
    if (given_ != 0) columns_[unknown(0)] = {joint(first).axis, p};
    for (std::size_t place = 1; place < leg_.joint_count; ++place) {
      const LegJoint i = leg_.chain_joints[place];
      const Joint& hinge = joint(i);
      if (hinge.anchor != Position()) p = p + R * scaled(hinge.anchor);
      const Direction turn = turn_about(R, hinge.axis, hinge_angle(i));
      if (place != given_) columns_[unknown(place)] = {turn, p};
    }
    const Direction normal = column(R, &Direction::z);
    const Ratio ankle_height = scaled(leg_.ankle_height);
    p = p - Direction{fixed::product<Ratio>(ankle_height, normal.x),
                      fixed::product<Ratio>(ankle_height, normal.y),
                      fixed::product<Ratio>(ankle_height, normal.z)};
    for (std::size_t i = 0; i < unknowns_; ++i) {
      Twist& twist = columns_[i];
      twist.move = cross(twist.turn, p - twist.move);
    }
    sole_ = p;
    forward_ = column(R, &Direction::x);
    missing_ = target_ - p;
    error_.move = clamped(missing_);
    if (leg_.can_turn()) {
      error_.turn = half_turn_to_target(R);
      return;
    }
    // A turn about the sole's normal is no error: the columns lose it as well.
    const Direction target_normal = column(R_target_, &Direction::z);
    error_.turn = cross(normal, target_normal);
    for (std::size_t i = 0; i < unknowns_; ++i) {
      Direction& turn = columns_[i].turn;
      const Ratio along = dot(target_normal, turn);
      turn = turn - Direction{fixed::product<Ratio>(along, target_normal.x),
                              fixed::product<Ratio>(along, target_normal.y),
                              fixed::product<Ratio>(along, target_normal.z)};
    }
  }

  // Half of the sum of x cross x', y cross y' and z cross z', which is the axis times the sine of the angle.
  // Its elements are inner products of rows of the two rotations, at most 2^60 each.
  [[nodiscard]] Direction half_turn_to_target(const Rotation& R) const {
    const auto element = [&](std::size_t i, std::size_t j) {
      const std::int64_t twice_raw = sum_of_products_raw(R.rows[i], R_target_.rows[j]) -
                                     sum_of_products_raw(R.rows[j], R_target_.rows[i]);
      return Ratio::from_wide_raw(fixed::shift_rounded(twice_raw, Ratio::kFractionBits + 1));
    };
    return {element(1, 2), element(2, 0), element(0, 1)};
  }

  [[nodiscard]] bool is_reached() const {
    return is_within(missing_, scaled(kReachTolerance)) && is_within(error_.turn, kTurnTolerance);
  }

  // Factorises J^T J + lambda^2 I = G G^T, and in the last row solves G y = J^T e. Returns the least pivot.
  // Elements of a row are at most as large as its column of J, sqrt(2), or the error.
  std::int64_t factorise() {
    const std::size_t n = unknowns_;
    std::int64_t least_raw = std::int64_t{1} << 62;
    for (std::size_t j = 0; j < n; ++j) {
      const std::int64_t pivot_raw = remainder_raw(columns_[j], j, j) + kDamping_raw;
      least_raw = std::min(least_raw, pivot_raw);
      inverse_roots_[j] = inverse_root_raw(std::max(pivot_raw, kDamping_raw));
      for (std::size_t i = j + 1; i < n; ++i) G_[i][j] = divided(remainder_raw(columns_[i], i, j), j);
      G_[n][j] = divided(remainder_raw(error_, n, j), j);
    }
    return least_raw;
  }

  // 1 / sqrt(pivot) in 2^-kRootBits units: the least pivot is lambda^2, so that it fits.
  static std::int32_t inverse_root_raw(std::int64_t pivot_raw) {
    const fixed::InverseRoot root = fixed::inverse_square_root(static_cast<std::uint64_t>(pivot_raw));
    const int shift = root.shift - Ratio::kFractionBits - kRootBits;
    return static_cast<std::int32_t>(root.mantissa >> shift);
  }

  // The inner product with column j, less the parts of the unknowns before j.
  [[nodiscard]] std::int64_t remainder_raw(const Twist& row, std::size_t i, std::size_t j) const {
    const auto& G_i = G_[i];
    const auto& G_j = G_[j];
    std::int64_t less_raw = 0;
    for (std::size_t k = 0; k < j; ++k) less_raw += std::int64_t{G_i[k]} * G_j[k];
    return inner_product_raw(row, columns_[j]) - less_raw;
  }

  // Divides by the root of the pivot of an unknown; saturates. A tie, which rounds up, takes round numbers.
  [[nodiscard]] std::int32_t divided(std::int64_t sum_raw, std::size_t j) const {
    constexpr std::int64_t kHalfLsb = std::int64_t{1} << (Ratio::kFractionBits - 1);
    constexpr std::int64_t kHalf = std::int64_t{1} << (kRootBits - 1);
    const auto numerator = fixed::saturate<std::int32_t>((sum_raw + kHalfLsb) >> Ratio::kFractionBits);
    return fixed::saturate<std::int32_t>((std::int64_t{numerator} * inverse_roots_[j] + kHalf) >> kRootBits);
  }

  void step() {
    factorise();
    const std::size_t n = unknowns_;
    std::array<std::int32_t, kLegJoints> changes_raw{};
    stopped_ = false;
    for (std::size_t i = n; i-- > 0;) {
      std::int64_t sum_raw = std::int64_t{G_[n][i]} << Ratio::kFractionBits;
      for (std::size_t k = i + 1; k < n; ++k) sum_raw -= std::int64_t{G_[k][i]} * changes_raw[k];
      changes_raw[i] = turn(joint_of(i), Ratio::from_raw(divided(sum_raw, i))).raw();
    }
  }

  // Turns a joint within its limits. Returns by how much, in rad.
  Ratio turn(LegJoint i, Ratio wanted_rad) {
    if (i == kKnee) wanted_rad = change_of_bend(wanted_rad);
    const Ratio limited_rad = std::clamp(wanted_rad, -kMaxStep, kMaxStep);
    Angle& angle = result_.angles[i];
    const Angle before = angle;
    const Angle wanted =
        Angle::from_raw(fixed::add_saturated(before.raw(), fixed::from_rad(limited_rad).raw()));
    angle = clamp_to_limits(joint(i), wanted);
    if (fixed::abs(angle - wanted) > kLimitTolerance) stopped_ = true;
    return fixed::in_rad(angle - before);
  }

  // The change of the knee whose cosine changes as the Newton step has it. Where the hip axes do not meet,
  // the leg is straight at a few degrees of bend, and a knee at its least bend is beyond that: it must bend
  // if the sole is to come nearer to the hip, whatever the slope there is.
  Ratio change_of_bend(Ratio wanted_rad) {
    const std::int8_t sign = leg_.signs[kKnee];
    const Angle bend = signed_by(sign, result_.angles[kKnee]) + bend_at_zero();
    Ratio more_rad = sign < 0 ? -wanted_rad : wanted_rad;
    if (bend >= kWellBent && fixed::abs(more_rad) <= kSmallBend) return wanted_rad;
    const bool must_shorten = dot(error_.move, sole_) < Ratio();
    if (bend <= kMinBend && must_shorten) more_rad = fixed::abs(more_rad);
    const auto [s, c] = fixed::sin_cos(std::max(bend, kMinBend));
    const Ratio cosine = c - fixed::product<Ratio>(s, more_rad);
    const bool too_straight = cosine > kCosineOfMinBend;
    if (too_straight) stopped_ = true;
    const Angle change = (too_straight ? kMinBend : fixed::acos(cosine)) - bend;
    return fixed::in_rad(signed_by(sign, std::clamp(change, -90.0_deg, 90.0_deg)));
  }

  [[nodiscard]] Angle bend_at_zero() const { return leg_.shank_tilt - leg_.thigh_tilt; }

  void measure_heading() {
    const Direction wanted = column(R_target_, &Direction::x);
    const Direction normal = column(R_target_, &Direction::z);
    result_.missing_heading = fixed::atan2(dot(normal, cross(forward_, wanted)), dot(forward_, wanted));
  }

  // In units of the scale. No length of the leg exceeds one.
  [[nodiscard]] Ratio scaled(Length length) const { return Ratio::from_raw(length.raw() * (1 << shift_)); }
  [[nodiscard]] Direction scaled(const Position& p) const { return {scaled(p.x), scaled(p.y), scaled(p.z)}; }

  static Direction clamped(const Direction& v) {
    const auto component = [](Ratio ratio) { return std::clamp(ratio, -kMaxError, kMaxError); };
    return {component(v.x), component(v.y), component(v.z)};
  }

  // The unknown that is the joint at this place of the chain, and back. The knee is the last one, and a given
  // yaw, which is above it, is none.
  [[nodiscard]] std::size_t unknown(std::size_t place) const {
    const std::size_t knee = leg_.joint_count - 3;
    if (place == knee) return unknowns_ - 1;
    const std::size_t before = place > given_ ? place - 1 : place;
    return place < knee ? before : before - 1;
  }
  [[nodiscard]] LegJoint joint_of(std::size_t unknown) const {
    const std::size_t knee = unknowns_ - 3;
    const std::size_t last = unknowns_ - 1;
    const std::size_t place = unknown < knee ? unknown : unknown == last ? knee : unknown + 1;
    return leg_.chain_joints[place >= given_ ? place + 1 : place];
  }
  static std::size_t place_of_yaw(const LegGeometry& leg) {
    return static_cast<std::size_t>(std::ranges::find(leg.chain(), kHipYaw) - leg.chain().begin());
  }

  [[nodiscard]] const Joint& joint(LegJoint i) const { return model_.joints[leg_.hinges[i]]; }
  [[nodiscard]] Angle hinge_angle(LegJoint i) const {
    if (i != kHipYaw || !leg_.shares_yaw) return result_.angles[i];
    return fixed::product<Angle>(yaw_, leg_.yaw_multiplier) + leg_.yaw_offset;
  }

  const RobotModel& model_;
  const LegGeometry& leg_;
  const std::size_t unknowns_;  // joints of the leg, but for a given yaw
  const std::size_t given_;     // place of that in the chain; kLegJoints: none
  const Angle yaw_;             // of its motor's joint
  const int shift_;             // from a Length to a Ratio in units of the scale
  // In axes of the base, from the anchor of the first joint, in units of the scale.
  Direction target_;
  Direction sole_;
  Direction missing_;  // from sole to target
  Rotation R_target_;
  LegAngles result_;
  std::array<Twist, kLegJoints> columns_{};  // of J, by unknown
  Twist error_;
  Direction forward_;  // x axis of the sole
  std::array<std::array<std::int32_t, kLegJoints>, kLegJoints + 1> G_{};
  std::array<std::int32_t, kLegJoints> inverse_roots_{};  // in 2^-kRootBits units
  bool stopped_ = false;                                  // by a limit or the straight knee, in the last step
};

}  // namespace

LegAngles newton_leg_inverse_kinematics(const RobotModel& model, const LegGeometry& geometry,
                                        const Pose& X_BSole, const LegAngles* last, FirstSolution first,
                                        Angle yaw) {
  return NewtonLeg(model, geometry, X_BSole, yaw).solve(last, first);
}

bool is_movable(const RobotModel& model, const LegGeometry& geometry) {
  return NewtonLeg(model, geometry, Pose(), Angle()).least_pivot_raw() >= kMinPivot_raw;
}

}  // namespace koboshi::robot
