#include "simulation/assembly/robot_parameters.h"

#include "base/text/error.h"
#include "firmware/app/factory_parameters.h"
#include "simulation/assembly/parameters.h"
#include "simulation/model/image_writer.h"

namespace koboshi::simulation {

std::vector<std::byte> compile_robot_parameters(const RobotParameters& parameters,
                                                const robot::RobotModel& model) {
  if (parameters.file.empty()) return {};
  check_robot_parameters(parameters, model);
  ImageWriter writer;
  writer.u32(model.id);
  for (const SdoWrite& write : resolve_parameters(parameters.settings)) {
    if (write.address.index == app::kNmtStartupObject) {
      throw InputError(write.parameter.source, write.parameter.line, write.parameter.text,
                       "parameters of the robot; this one is the network's");
    }
    writer.u16(write.address.index);
    writer.u8(write.address.subindex);
    writer.u8(write.size_bytes);
    writer.u32(write.value);
  }
  return writer.finish(app::kFactoryParametersMagic, app::kFactoryParametersVersion);
}

}  // namespace koboshi::simulation
