#include "tools/studio/window/motion_upload.h"

#include <QCoreApplication>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <vector>

#include "firmware/motion/motion.h"
#include "sim_board/can/transport/transport.h"
#include "sim_board/input/error.h"
#include "sim_board/robot/load.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion/compile.h"
#include "tools/motion/remote/robot_motions.h"

namespace koboshi::studio {

std::string upload(const MotionUpload& upload) {
  const simulation::NamedModel robot = simulation::load_named_model(sim::load_robot(upload.robot));
  const std::vector<std::byte> image = simulation::compile_motion(upload.motion, robot);
  motion::Motion motion;
  if (const auto verdict = motion::Motion::open(image, robot.model, motion); !verdict.ok())
    throw sim::InputError(upload.motion, 0, simulation::describe(verdict.status), "a motion for this robot");
  const std::unique_ptr<sim::Transport> transport = sim::open_transport(upload.transport, upload.options);
  if (!transport) throw std::invalid_argument("found no bus, expected one to which a robot is connected");
  if (upload.channel) upload.channel->wait();
  tools::RobotMotions motions(*transport);
  const std::uint16_t number = motions.number_for(motion.name());
  motions.upload(number, {reinterpret_cast<const std::uint8_t*>(image.data()), image.size()});
  return QCoreApplication::translate("MainWindow",
                                     "%1 is motion %2 of the robot on %3: %4 bytes, read back the same")
      .arg(QString::fromUtf8(motion.name().data(), static_cast<int>(motion.name().size())))
      .arg(number)
      .arg(QString::fromStdString(upload.transport))
      .arg(static_cast<qulonglong>(image.size()))
      .toStdString();
}

}  // namespace koboshi::studio
