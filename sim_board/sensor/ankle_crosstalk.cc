#include "sim_board/sensor/ankle_crosstalk.h"

namespace koboshi::sim {

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

}  // namespace koboshi::sim
