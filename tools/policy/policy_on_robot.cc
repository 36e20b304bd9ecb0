#include "tools/policy/policy_on_robot.h"

#include <algorithm>
#include <stdexcept>

#include "firmware/app/dictionary.h"
#include "firmware/drive/configuration.h"

namespace koboshi::tools {

PolicyOnRobot::PolicyOnRobot(sim_board::Transport& transport) : sdo_(transport, drive::kControllerNodeId) {}

void PolicyOnRobot::upload(std::span<const std::byte> image) {
  const std::span bytes{reinterpret_cast<const std::uint8_t*>(image.data()), image.size()};
  try {
    sdo_.download({app::kPolicyObject, 0}, bytes);
  } catch (const bus::SdoAborted& aborted) {
    if (aborted.code() == canopen::AbortCode::kInvalidValue)
      throw std::runtime_error("the robot refuses the policy: it is not for this robot");
    if (aborted.code() == canopen::AbortCode::kDeviceState)
      throw std::runtime_error("the robot stores a policy only while it stands, plays a motion or is limp");
    throw;
  }
  if (!std::ranges::equal(download(), bytes))
    throw std::runtime_error("the policy reads back with other bytes");
}

std::vector<std::uint8_t> PolicyOnRobot::download() { return sdo_.upload({app::kPolicyObject, 0}); }

}  // namespace koboshi::tools
