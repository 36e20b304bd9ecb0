#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim_board/description/description.h"
#include "tools/robot_file/check/finding.h"
#include "tools/robot_file/check/mesh_store.h"
#include "tools/robot_file/check/model_check.h"
#include "tools/robot_file/check/places.h"

namespace koboshi::tools {

// A robot that the reader accepts, for the checks below, and what they have found.
class CheckedModel {
 public:
  CheckedModel(const sim_board::RobotDescription& robot, const ModelPlaces& places, MeshStore& meshes,
               std::vector<ModelFinding>& findings)
      : robot(robot), places(places), meshes(meshes), findings_(findings) {}

  // The place is that of ModelPlaces::of().
  void add(std::string code, simulation::Severity severity, const ModelPlace& place, std::string found,
           std::string expected, std::string repair = {}) {
    findings_.push_back({.code = std::move(code),
                         .severity = severity,
                         .found = std::move(found),
                         .expected = std::move(expected),
                         .repair = std::move(repair)});
    set_place(findings_.back(), place);
  }
  void warn(std::string code, const ModelPlace& place, std::string found, std::string expected,
            std::string repair = {}) {
    add(std::move(code), simulation::Severity::kWarning, place, std::move(found), std::move(expected),
        std::move(repair));
  }

  // The finding that was added last.
  ModelFinding& last() { return findings_.back(); }

  const sim_board::RobotDescription& robot;
  const ModelPlaces& places;
  MeshStore& meshes;

 private:
  std::vector<ModelFinding>& findings_;
};

// Boxes that overlap by less only touch, as in the motion check.
inline constexpr double kTouchingBoxes_m = 0.0005;
// Returns the deepest overlap of a box of one link with a box of the other.
double overlap_m(const sim_board::LinkDescription& a, const Eigen::Isometry3d& X_MA,
                 const sim_board::LinkDescription& b, const Eigen::Isometry3d& X_MB);

// Each finds one kind of fault, by the code in docs/reference/model-check.md.
void check_inertias(CheckedModel& model);                 // R002
void check_sides(CheckedModel& model);                    // R003
void check_meshes(CheckedModel& model, double height_m);  // R004, R005, R006, R010; height of the robot
void check_overlaps(CheckedModel& model);                 // R007
void check_ranges(CheckedModel& model);                   // R032
void check_soles(CheckedModel& model);                    // R008
std::optional<Squat> check_squat(CheckedModel& model);    // R009
// R028, R029. The robot must be that of the file itself: the lines are those of its description.
void check_firmware(CheckedModel& model);

}  // namespace koboshi::tools
