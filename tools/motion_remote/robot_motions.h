#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "bus/can/sdo_transfer.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::tools {

// A motion that a robot on the bus can play.
struct RobotMotion {
  std::uint16_t number = 0;
  std::string name;
  std::uint32_t crc32 = 0;  // of its image
};

// The motions of a robot on the bus, by the controller's objects 0x2400 to 0x2402, and playing them by its
// first RPDO. All functions block; they throw SdoAborted, and std::runtime_error if the controller does not
// answer.
class RobotMotions {
 public:
  // The transport must outlive this.
  explicit RobotMotions(sim_board::Transport& transport);

  // Returns the motions that the robot can play, in the order of their numbers.
  std::vector<RobotMotion> list();
  // Returns the image of a motion.
  std::vector<std::uint8_t> download(std::uint16_t number, const bus::SdoProgress& progress = {});
  // Stores an image under this number and reads it back. Throws std::runtime_error if the robot returns other
  // bytes.
  void upload(std::uint16_t number, std::span<const std::uint8_t> image,
              const bus::SdoProgress& progress = {});

  // Returns the number of the motion with this name, or of one that `text` is the number of. Throws
  // std::invalid_argument with the names there are.
  std::uint16_t find(std::string_view text);
  // Returns the number under which to store a motion with this name: its own if the robot has one of that
  // name, else the lowest free one. Throws std::runtime_error if none is free.
  std::uint16_t number_for(std::string_view name);

  // Commands the robot to play a motion and returns once it has ended. Throws std::runtime_error that names
  // the reason if the robot refuses, if the motion is cut off, for instance by a fall, or if no telemetry
  // comes.
  void play(std::uint16_t number);

 private:
  struct Telemetry;

  Telemetry next_telemetry();

  sim_board::Transport& transport_;
  bus::SdoTransfer sdo_;
};

}  // namespace koboshi::tools
