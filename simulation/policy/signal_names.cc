#include "simulation/policy/signal_names.h"

#include <array>
#include <cmath>
#include <numbers>

#include "firmware/policy/signals.h"

namespace koboshi::simulation {
namespace {

using policy::Signal;

constexpr double kTwoPi = 2.0 * std::numbers::pi;

struct GeneralSignal {
  std::string_view name;
  double unit;  // times 2^-bits
  int bits;
  std::string_view symbol;
};

// By Signal, up to the first joint's.
constexpr std::array<GeneralSignal, 24> kGeneralSignals = {{
    {"roll", kTwoPi, 24, "rad"},
    {"pitch", kTwoPi, 24, "rad"},
    {"planned_pitch", kTwoPi, 24, "rad"},
    {"up_x", 1.0, 24, ""},
    {"up_y", 1.0, 24, ""},
    {"up_z", 1.0, 24, ""},
    {"roll_rate", kTwoPi, 20, "rad/s"},
    {"pitch_rate", kTwoPi, 20, "rad/s"},
    {"yaw_rate", kTwoPi, 20, "rad/s"},
    {"acceleration_x", 1.0, 16, "m/s^2"},
    {"acceleration_y", 1.0, 16, "m/s^2"},
    {"acceleration_z", 1.0, 16, "m/s^2"},
    {"velocity_forward", 0.001, 14, "m/s"},
    {"velocity_left", 0.001, 14, "m/s"},
    {"velocity_turn", 0.001, 14, "rad/s"},
    {"left_load", 1.0, 16, "N"},
    {"right_load", 1.0, 16, "N"},
    {"left_zmp_x", 1.0, 24, "m"},
    {"left_zmp_y", 1.0, 24, "m"},
    {"right_zmp_x", 1.0, 24, "m"},
    {"right_zmp_y", 1.0, 24, "m"},
    {"phase_sin", 1.0, 24, ""},
    {"phase_cos", 1.0, 24, ""},
    {"swing", 1.0, 24, ""},
}};
static_assert(kGeneralSignals.size() == static_cast<std::size_t>(Signal::kJointAngle));

std::uint8_t place(Signal first, std::size_t number) {
  return static_cast<std::uint8_t>(static_cast<std::size_t>(first) + number);
}

}  // namespace

std::vector<SignalName> signal_names(std::span<const std::string> joints,
                                     std::span<const std::string> outputs) {
  std::vector<SignalName> names;
  for (const GeneralSignal& signal : kGeneralSignals) {
    names.push_back({std::string(signal.name), static_cast<std::uint8_t>(names.size()),
                     std::ldexp(signal.unit, -signal.bits), signal.symbol});
  }
  const double angle = std::ldexp(kTwoPi, -24);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    names.push_back({joints[i] + ".angle", place(Signal::kJointAngle, i), angle, "rad"});
    names.push_back({joints[i] + ".rate", place(Signal::kJointRate, i), std::ldexp(kTwoPi, -20), "rad/s"});
    names.push_back({joints[i] + ".target", place(Signal::kJointTarget, i), angle, "rad"});
  }
  for (std::size_t i = 0; i < outputs.size(); ++i)
    names.push_back({"output." + outputs[i], place(Signal::kOutput, i), angle, "rad"});
  return names;
}

}  // namespace koboshi::simulation
