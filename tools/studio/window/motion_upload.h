#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "sim_board/can/transport/transport.h"
#include "tools/studio/run/sdo_loan.h"

namespace koboshi::studio {

// A motion on its way to a robot on a CAN bus.
struct MotionUpload {
  std::filesystem::path motion;  // a source
  std::filesystem::path robot;   // the file for which it is compiled
  std::string transport;         // as for sim::open_transport
  sim::TransportOptions options{};
  std::shared_ptr<SdoLoan> channel{};  // of a bus that the window follows; null: none
};

// Compiles a motion, stores it in the controller and reads it back. It blocks. Returns one line for the user.
// Throws sim::InputError for a motion with errors, what sim::open_transport throws, and what RobotMotions
// throws.
std::string upload(const MotionUpload& upload);

}  // namespace koboshi::studio
