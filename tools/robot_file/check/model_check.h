#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim_board/description/description.h"
#include "tools/robot_file/check/finding.h"
#include "tools/robot_file/check/mesh_store.h"

namespace koboshi::tools {

// The deepest squat that is judged: knees bent by a right angle, the trunk upright above the feet.
struct Squat {
  std::string joint{};  // the one that is loaded most
  double torque_Nm = 0.0;
  double share = 0.0;  // of the torque of its servo at the lowest supply
};

struct ModelReport {
  std::filesystem::path file{};
  // None: the reader refuses the file, and no repair is certain enough to go on.
  std::optional<sim_board::RobotDescription> robot{};
  bool is_repaired = false;  // the reader refuses the file; `robot` is that of the file with its repairs
  Eigen::Vector3d com_M_m = Eigen::Vector3d::Zero();
  double height_m = 0.0;                         // at joint angles zero, of the collision boxes
  std::array<std::optional<double>, 2> leg_m{};  // from hip to ankle when the leg is straight, by side
  std::optional<Squat> squat{};                  // none: the robot has no such legs
  std::vector<ModelFinding> findings{};          // in the order of their lines

  bool has_errors() const;
};

// Checks robot files, saved or not, one after the other. Mesh files that have not changed are not read again.
class ModelChecker {
 public:
  // Finds everything for which the reader would refuse the text, and what a robot should not have. Paths in
  // it are relative to `file`, which need not exist.
  [[nodiscard]] ModelReport check(const std::filesystem::path& file, const std::string& text);
  // The same for a text from which the caller has loaded the robot, which saves a second reading.
  [[nodiscard]] ModelReport check(const std::filesystem::path& file, const std::string& text,
                                  sim_board::RobotDescription robot);

 private:
  MeshStore meshes_;
};

// Checks a file once. Throws InputError if it cannot be read.
[[nodiscard]] ModelReport check_model(const std::filesystem::path& file);
// Checks a text instead of the file's.
[[nodiscard]] ModelReport check_model(const std::filesystem::path& file, const std::string& text);

// For people: tree, masses, sizes, and a line for each finding, FILE:LINE: severity[CODE]: found ...,
// expected ..., with its repair below.
[[nodiscard]] std::string model_report_text(const ModelReport& report);
// An object with the same content; the keys end with their units.
[[nodiscard]] std::string model_report_json(const ModelReport& report);

}  // namespace koboshi::tools
