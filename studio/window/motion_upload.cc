#include "studio/window/motion_upload.h"

#include <cstddef>
#include <stdexcept>

#include "base/text/error.h"
#include "firmware/motion/motion.h"
#include "sim_board/can/transport/transport.h"
#include "sim_board/description/load.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion_language/compile/compile.h"
#include "tools/motion_remote/robot_motions.h"

namespace koboshi::studio {

MotionImage compile_image(const std::filesystem::path& motion, const std::filesystem::path& robot) {
  const simulation::NamedModel model = simulation::load_named_model(sim_board::load_robot(robot));
  const std::vector<std::byte> image = simulation::compile_motion(motion, model);
  motion::Motion read;
  if (const auto verdict = motion::Motion::open(image, model.model, read); !verdict.ok())
    throw InputError(motion, 0, simulation::describe(verdict.status), "a motion for this robot");
  const auto* const begin = reinterpret_cast<const std::uint8_t*>(image.data());
  return {std::string(read.name()), {begin, begin + image.size()}};
}

UploadedMotion upload(const MotionUpload& upload) {
  const MotionImage image = compile_image(upload.motion, upload.robot);
  const std::unique_ptr<sim_board::Transport> transport =
      sim_board::open_transport(upload.transport, upload.options);
  if (!transport) throw std::invalid_argument("found no bus, expected one to which a robot is connected");
  if (upload.channel) upload.channel->wait();
  tools::RobotMotions motions(*transport);
  const std::uint16_t number = motions.number_for(image.name);
  motions.upload(number, image.bytes);
  return {number, image.name, image.bytes.size()};
}

}  // namespace koboshi::studio
