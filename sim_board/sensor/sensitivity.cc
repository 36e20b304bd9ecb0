#include "sim_board/sensor/sensitivity.h"

#include <string>

namespace koboshi::sim_board {

AxisGains::AxisGains(double scale_error, double cross_axis, std::uint64_t seed, std::string_view name) {
  RandomStream scale(seed, std::string(name) + ".scale");
  RandomStream cross(seed, std::string(name) + ".cross_axis");
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      value_(row, column) = row == column ? 1.0 + scale.within(scale_error) : cross.within(cross_axis);
    }
  }
}

CrossSensitivity::CrossSensitivity(double largest, std::uint64_t seed, std::string_view name) {
  RandomStream random(seed, name);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) value_(row, column) = random.within(largest);
  }
}

AnkleCrosstalk::AnkleCrosstalk(const AnkleSensorDescription& description, const SensorErrors& errors)
    : force_by_torque_(
          description.crosstalk * errors.scale * description.force.range / description.torque.range,
          errors.seed, description.name + ".force.crosstalk"),
      torque_by_force_(
          description.crosstalk * errors.scale * description.torque.range / description.force.range,
          errors.seed, description.name + ".torque.crosstalk") {}

Wrench AnkleCrosstalk::apply(const Wrench& wrench) const {
  return {wrench.force_N + force_by_torque_.value() * wrench.torque_Nm,
          wrench.torque_Nm + torque_by_force_.value() * wrench.force_N};
}

}  // namespace koboshi::sim_board
