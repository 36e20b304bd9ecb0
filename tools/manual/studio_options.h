#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "sim_board/can/transport/transport.h"
#include "tools/run/transport_options.h"

namespace koboshi::tools {

inline constexpr const char* kStudioDescription =
    "Koboshi Studio: run, watch and push the robot, and edit its motions.";

// The command line of koboshi-studio, which koboshi uses for its manual.
struct StudioArguments {
  std::vector<std::filesystem::path> files;
  std::filesystem::path robot = "robots/koboshi/robot.sdf";
  CLI::Option* robot_option = nullptr;
  std::string can;
  sim_board::TransportOptions transport{};
};

// `arguments` must outlive the program.
inline void add_studio_options(CLI::App& program, StudioArguments& arguments) {
  program
      .add_option("FILE", arguments.files,
                  "Scenarios and motions, or their names, and folders or files of recorded runs to open")
      ->type_name("");
  arguments.robot_option =
      program
          .add_option("--robot", arguments.robot,
                      "The robot that is edited, and with which scenarios start instead of their own")
          ->type_name("ROBOT")
          ->capture_default_str();
  auto* can_option =
      program
          .add_option("--can", arguments.can,
                      "Follow a robot on a bus: socketcan:INTERFACE, udp:ADDRESS:PORT or slcan")
          ->type_name("BUS");
  for (CLI::Option* option : add_transport_options(program, arguments.transport)) option->needs(can_option);
}

}  // namespace koboshi::tools
