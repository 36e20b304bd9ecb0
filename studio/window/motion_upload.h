#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sim_board/can/transport/transport.h"
#include "studio/run/sdo_loan.h"

namespace koboshi::studio {

// A compiled motion as a controller stores it.
struct MotionImage {
  std::string name;  // under which the controller lists it
  std::vector<std::uint8_t> bytes;
};

// Compiles a motion's source for the robot of this file. Throws InputError for a motion with errors.
[[nodiscard]] MotionImage compile_image(const std::filesystem::path& motion,
                                        const std::filesystem::path& robot);

// A motion on its way to a robot on a CAN bus.
struct MotionUpload {
  std::filesystem::path motion;  // a source
  std::filesystem::path robot;   // the file for which it is compiled
  std::string transport;         // as for sim_board::open_transport
  sim_board::TransportOptions options{};
  std::shared_ptr<SdoLoan> channel{};  // of a bus that the window follows; null: none
};

// A motion in the storage of a controller.
struct UploadedMotion {
  std::uint16_t number = 0;
  std::string name;
  std::size_t bytes = 0;
};

// Compiles a motion, stores it in the controller and reads it back. It blocks. Throws InputError for a
// motion with errors, what sim_board::open_transport throws, and what RobotMotions throws.
UploadedMotion upload(const MotionUpload& upload);

}  // namespace koboshi::studio
