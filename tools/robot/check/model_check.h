#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim_board/robot/description.h"
#include "simulation/motion/diagnostic.h"

namespace koboshi::tools {

// A finding about a robot file; docs/reference/model-check.md lists the codes.
struct ModelFinding {
  std::string code{};  // "R003"
  simulation::Severity severity = simulation::Severity::kWarning;
  int line = 0;  // of the file; 0: the file as a whole
  std::string found{};
  std::string expected{};
  std::string repair{};  // a whole sentence, empty if there is none
};

// The deepest squat that is judged: knees bent by a right angle, the trunk upright above the feet.
struct Squat {
  std::string joint{};  // the one that is loaded most
  double torque_Nm = 0.0;
  double share = 0.0;  // of the torque of its servo at the lowest supply
};

struct ModelReport {
  std::filesystem::path file{};
  std::optional<sim::RobotDescription> robot{};  // none: the reader has refused the file
  Eigen::Vector3d com_M_m = Eigen::Vector3d::Zero();
  double height_m = 0.0;                         // at joint angles zero, of the collision boxes
  std::array<std::optional<double>, 2> leg_m{};  // from hip to ankle when the leg is straight, by side
  std::optional<Squat> squat{};                  // none: the robot has no such legs
  std::vector<ModelFinding> findings{};          // in the order of their lines

  bool has_errors() const;
};

// Checks a robot's file for what the reader accepts and a robot should not have. An error of the reader
// becomes the only finding.
[[nodiscard]] ModelReport check_model(const std::filesystem::path& file);
// Checks a text instead of the file's.
[[nodiscard]] ModelReport check_model(const std::filesystem::path& file, const std::string& text);

// For people: tree, masses, sizes, and a line for each finding, FILE:LINE: severity[CODE]: found ...,
// expected
// ..., with its repair below.
[[nodiscard]] std::string model_report_text(const ModelReport& report);
// An object with the same content; the keys end with their units.
[[nodiscard]] std::string model_report_json(const ModelReport& report);

}  // namespace koboshi::tools
