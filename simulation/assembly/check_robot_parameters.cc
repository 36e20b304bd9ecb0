// Checks that a robot's parameters are consistent with its body.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "base/text/user_units.h"
#include "firmware/app/controller_objects.h"
#include "firmware/estimation/posture.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/walk/body.h"
#include "sim_board/world/gravity.h"
#include "simulation/assembly/controller_parameters.h"
#include "simulation/assembly/parameters.h"
#include "simulation/assembly/robot_parameters.h"

namespace koboshi::simulation {
namespace {

using canopen::ObjectAddress;
using fixed::to_double;

constexpr double kMetresPerCount = 1e-4;                         // unit of the lengths in the walk's objects
constexpr double kRadPerCount = 2.0 * std::numbers::pi / 65536;  // unit of the angles
constexpr double kDown_rad =
    std::numbers::pi / 3.0;  // lean at which the robot counts as down (behaviour/lying_pose.h)
// Accuracy of walk::Body for the height of the centre of mass: the knees are in front of the line from hip to
// ankle.
constexpr double kComTolerance = 0.03;  // of the height: robots of any size
constexpr double kSoleTolerance_m = 0.5e-3;
constexpr double kSoleTilt = 4e-3;  // rad, 0.5 mm over a step of 125 mm

constexpr std::uint16_t kSupply = 0x2100;
constexpr std::uint16_t kSteps = 0x2130;
constexpr std::uint16_t kPosture = 0x2131;
constexpr std::uint16_t kReactions = 0x2132;
constexpr std::uint16_t kFall = 0x2140;
constexpr ObjectAddress kStepWidth{kSteps, 3};
constexpr ObjectAddress kMaxStepLength{kSteps, 9};
constexpr ObjectAddress kWidestStep{kSteps, 10};
constexpr ObjectAddress kNarrowestStep{kSteps, 11};
constexpr ObjectAddress kComHeight{kPosture, 1};
// The parameters that a walk requires (walk::is_gait).
constexpr std::array kGait{ObjectAddress{kSteps, 1},
                           kStepWidth,
                           ObjectAddress{kSteps, 6},
                           ObjectAddress{kSteps, 7},
                           kMaxStepLength,
                           ObjectAddress{kSteps, 8},
                           kWidestStep,
                           kNarrowestStep,
                           kComHeight};
// The parameters that fall detection requires (behaviour::FallLimits::are_set), the front first.
constexpr std::array kFallLimits{ObjectAddress{kFall, 1}, ObjectAddress{kFall, 2}, ObjectAddress{kFall, 3},
                                 ObjectAddress{kFall, 5}};

double metres(std::int16_t count) { return kMetresPerCount * count; }

class RobotParameterCheck {
 public:
  RobotParameterCheck(const RobotParameters& parameters, const robot::RobotModel& model)
      : parameters_(parameters),
        model_(model),
        writes_(resolve_parameters(parameters.settings)),
        values_(controller_values(parameters)),
        body_(model) {}

  void check() const {
    check_supply();
    check_complete(kGait, "a gait");
    check_complete(kFallLimits, "fall detection");
    if (is_given(kGait.front())) {
      if (!body_.has_legs())
        throw error(kGait.front(), "no gait of a robot whose legs cannot walk", "legs that walk");
      check_soles();
      check_reach();
    }
    if (values_.recovery.fall.are_set()) check_fall_limits();
    check_touchdown();
  }

 private:
  const SdoWrite* find(const ObjectAddress& address) const {
    const auto found = std::ranges::find(writes_, address, &SdoWrite::address);
    return found == writes_.end() ? nullptr : &*found;
  }
  bool is_given(const ObjectAddress& address) const {
    const SdoWrite* write = find(address);
    return write != nullptr && write->value != 0;
  }
  static std::string key_of(const ObjectAddress& address) {
    return std::ranges::find(controller_parameters(), address, &Parameter::address)->key;
  }

  // Returns an error at the parameter's line, or for the whole file if the parameter is missing.
  InputError error(const ObjectAddress& address, const std::string& expected,
                   const std::string& limit) const {
    const auto setting =
        std::ranges::find(parameters_.settings, key_of(address),
                          [](const ParameterSetting& each) -> const std::string& { return each.name.text; });
    if (setting == parameters_.settings.end())
      return {parameters_.file, 0, "no " + key_of(address), expected, limit};
    return {setting->name.source, setting->name.line,
            fmt::format("{} = {}", setting->name.text, setting->value), expected, limit};
  }

  // Checks that all or none of the parameters are given. A first one of 0 turns the function off.
  template <std::size_t kCount>
  void check_complete(const std::array<ObjectAddress, kCount>& parts, const std::string& what) const {
    const SdoWrite* first = find(parts.front());
    const bool is_off = first != nullptr && first->value == 0;
    if (is_off || std::ranges::none_of(parts, [this](const auto& part) { return is_given(part); })) return;
    for (const ObjectAddress& part : parts) {
      if (!is_given(part)) throw error(part, "the whole of " + what, "a whole set");
    }
  }

  void check_supply() const {
    const behaviour::PowerParameters& power = values_.parameters;
    if (power.supply_min_mV > power.supply_max_mV)
      throw error({kSupply, 1}, fmt::format("at most {} mV, the highest supply", power.supply_max_mV),
                  "the order of the supply limits");
    if (power.supply_low_mV != 0 && power.supply_low_mV < power.supply_min_mV)
      throw error({kSupply, 4}, fmt::format("at least {} mV, the lowest supply", power.supply_min_mV),
                  "the order of the supply limits");
  }

  // Checks that the soles do not touch at the narrowest distance of the feet.
  void check_soles() const {
    const double soles_m = to_double(model_.feet[1].left) - to_double(model_.feet[0].right);
    const auto& step = values_.walk.step;
    for (const auto& [address, width_m] :
         {std::pair{kStepWidth, metres(step.width)}, std::pair{kNarrowestStep, metres(step.min_lateral)}}) {
      if (width_m >= soles_m) continue;
      throw error(address, fmt::format("at least {:.4g} mm, with less the soles touch", 1e3 * soles_m),
                  "the width of the soles");
    }
    if (step.min_lateral > step.width)
      throw error(kNarrowestStep, "at most the step width", "the order of the step widths");
    if (step.max_lateral < step.width)
      throw error(kWidestStep, "at least the step width", "the order of the step widths");
  }

  void check_reach() const {
    const double width_m = metres(values_.walk.step.width);
    const double com_m = metres(values_.walk.posture.com_height);
    if (!reaches(com_m, 0.0, width_m)) {
      throw error(kComHeight, reachable_heights(width_m) + ", which the legs reach", "the reach of the legs");
    }
    check_step(kMaxStepLength, values_.walk.step.max_forward,
               [&](double step_m) { return reaches(com_m, step_m, width_m); });
    check_step(kWidestStep, values_.walk.step.max_lateral,
               [&](double step_m) { return reaches(com_m, 0.0, step_m); });
  }

  // Checks that the legs reach a step of this length, in counts.
  template <typename Reaches>
  void check_step(const ObjectAddress& address, std::int16_t step, const Reaches& reaches_step) const {
    if (reaches_step(metres(step))) return;
    int step_mm = static_cast<int>(1e3 * metres(step));
    while (step_mm > 0 && !reaches_step(1e-3 * step_mm)) --step_mm;
    throw error(address,
                fmt::format("a step that the legs reach at this CoM height, at most {} mm, or a lower {}",
                            step_mm, key_of(kComHeight)),
                "the reach of the legs");
  }

  std::string reachable_heights(double width_m) const {
    std::vector<int> heights_mm;
    for (int height_mm = 1; height_mm <= 1000; ++height_mm) {
      if (reaches(1e-3 * height_mm, 0.0, width_m)) heights_mm.push_back(height_mm);
    }
    if (heights_mm.empty()) return "a narrower step";
    return fmt::format("{} to {} mm", heights_mm.front(), heights_mm.back());
  }

  // Returns whether the legs can place both soles with the centre of mass above their middle at this height,
  // when the right foot is `step_m` behind and `width_m` beside the left one.
  bool reaches(double com_m, double step_m, double width_m) const {
    const auto length = [](double value_m) { return fixed::from_double<fixed::Length>(value_m); };
    walk::Stance stance;
    stance.pitch = fixed::Angle::from_raw(std::int32_t{values_.walk.posture.trunk_pitch} << 16);
    stance.soles[1].p = {length(-step_m), length(-width_m)};
    stance.centre_of_mass = {length(-step_m / 2), length(-width_m / 2), length(com_m)};
    std::array<fixed::Angle, robot::kMaxJoints> angles{};
    walk::Body body = body_;  // without a solution from which it would begin
    body.solve(stance, {}, angles);
    const estimation::Posture posture = estimation::posture_at(model_, {angles.data(), model_.joint_count});
    // In axes of the stance, not of a sole: a foot without hip yaw keeps the heading that the leg leaves it.
    const robot::Rotation R_StanceB = robot::rotation_about(robot::kAxisY, stance.pitch);
    const robot::Position right = R_StanceB * (posture.X_BSole[1].p - posture.X_BSole[0].p);
    const double com_error_m = to_double(posture.centre_of_mass(hal::Side::kLeft).z) - com_m;
    const auto is_level = [&](const robot::Pose& X_BSole) {
      const robot::Direction up = R_StanceB * column(X_BSole.R, &robot::Direction::z);
      return std::hypot(to_double(up.x), to_double(up.y)) < kSoleTilt;
    };
    return std::abs(com_error_m) < kComTolerance * com_m && std::ranges::all_of(posture.X_BSole, is_level) &&
           std::hypot(to_double(right.x) + step_m, to_double(right.y) + width_m, to_double(right.z)) <
               kSoleTolerance_m;
  }

  // A robot on flat feet tips over once its centre of mass is beyond their edge.
  void check_fall_limits() const {
    const std::array<fixed::Angle, robot::kMaxJoints> upright{};
    const estimation::Posture posture = estimation::posture_at(model_, {upright.data(), model_.joint_count});
    const bool walks = is_given(kComHeight);
    const double com_m = walks ? metres(values_.walk.posture.com_height)
                               : to_double(posture.centre_of_mass(hal::Side::kLeft).z);
    const double apart_m =
        to_double(posture.X_BSole[hal::Side::kLeft].p.y - posture.X_BSole[hal::Side::kRight].p.y);
    const robot::Foot& foot = model_.feet[0];
    const std::array edges_m{to_double(foot.front), -to_double(foot.back),
                             (walks ? metres(values_.walk.step.width) : apart_m) / 2 + to_double(foot.left)};
    const behaviour::FallLimits& limits = values_.recovery.fall;
    const std::array counts{limits.front, limits.back, limits.side};
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const double edge_rad = std::atan2(edges_m[i], com_m);
      const double limit_rad = kRadPerCount * counts[i];
      if (limit_rad >= edge_rad && limit_rad <= kDown_rad) continue;
      throw error(kFallLimits[i],
                  fmt::format("{:.3g} to {:.3g} deg: from the edge of the feet to a robot that is down",
                              kDegreesPerRad * edge_rad, kDegreesPerRad * kDown_rad),
                  "the edge of the feet");
    }
  }

  void check_touchdown() const {
    double mass_kg = to_double(model_.base_mass);
    for (std::size_t i = 0; i < model_.hinge_count(); ++i) mass_kg += to_double(model_.joints[i].mass);
    const double weight_N = mass_kg * sim_board::kGravity_m_per_s2;
    if (0.01 * values_.walk.reaction.touchdown_load_cN <= weight_N) return;
    throw error({kReactions, 5}, fmt::format("at most {:.3g} N, the weight of the robot", weight_N),
                "the weight of the robot");
  }

  const RobotParameters& parameters_;
  const robot::RobotModel& model_;
  const std::vector<SdoWrite> writes_;
  const app::ControllerValues values_;
  const walk::Body body_;
};

}  // namespace

void check_robot_parameters(const RobotParameters& parameters, const robot::RobotModel& model) {
  RobotParameterCheck(parameters, model).check();
}

}  // namespace koboshi::simulation
