#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/edit/yaml_document.h"
#include "base/yaml/yaml_tree.h"
#include "simulation/motion_language/parse/diagnostic.h"
#include "simulation/motion_language/parse/source.h"
#include "studio/document/motion_robot.h"

namespace koboshi::studio {

// A step of a motion as a row of a table, and as an event of a timeline.
//
// Times and angles are those of the nominal path: conditions of waits hold at once, those of branches hold,
// jumps are not taken, loops that a condition or a stop command ends run once.
struct MotionRow {
  YamlPath path = {};                      // "steps.2.loop.steps.0"
  std::size_t section = 0;                 // index into MotionRows::sections
  int depth = 0;                           // 0: a step of the section itself
  std::optional<std::size_t> parent = {};  // row of the loop or branch around it
  bool in_else = false;                    // a step of the parent's `else`
  std::size_t list_index = 0;              // in the list of steps around it
  int line = 0;                            // in the file, from 1

  // Kind of the step, as far as its keys tell; kEnd for an unknown one.
  simulation::StepSource::Kind kind = simulation::StepSource::Kind::kEnd;
  bool has_error = false;  // a message of the compiler is about these lines
  std::string text = {};   // the step without its body on one line, such as "loop 3 times"

  // Moves.
  std::string pose = {};      // name; empty for a pose that the step itself contains
  std::size_t pose_uses = 0;  // steps and poses that refer to this name
  bool mirrored = false;      // moves to the mirror image of the pose
  std::uint32_t moved = 0;    // mask of the joints that the move sets
  std::optional<double> speed_deg_per_s = {};
  motion::Interpolation interpolation = motion::Interpolation::kLinear;
  bool own_interpolation = false;  // given by the step, not by the file
  double pause_s = 0.0;

  // Moves by time or least time, waits, and the time-out of a wait for a condition.
  std::optional<double> time_s = {};
  bool at_least = false;  // a move that takes `time_s` or as much more as its joints need

  // Loops: count of repetitions. Empty: a condition or a stop command ends the loop.
  std::optional<int> times = {};

  // The label itself, or the label to which a jump, branch or time-out leads, or the called routine.
  std::string label = {};
  std::optional<std::size_t> target = {};  // row of that label, or first row of the routine

  double start_s = 0.0;                 // from the beginning of the section, in the first repetition
  double duration_s = 0.0;              // of one step with its pause; of a loop with all repetitions
  std::vector<double> angles_rad = {};  // by joint, at the end of the step; not moved yet: the standing pose
};

// The main program, or a routine.
struct MotionSection {
  std::string name = {};  // of the routine; empty: the main program
  YamlPath path = {};
  int line = 0;
  std::size_t first_row = 0;
  std::size_t row_count = 0;
  double duration_s = 0.0;
  int end_line = 0;  // the line after the last one
};

// The steps of a motion in the order of a table: the main program, then the routines as in the file. The
// steps of a loop or branch follow it.
struct MotionRows {
  std::vector<MotionSection> sections = {};  // the first is the main program, even if the file has none
  std::vector<MotionRow> rows = {};

  // Returns the row of a step, for a selection that outlives an edit.
  [[nodiscard]] std::optional<std::size_t> find(const YamlPath& path) const;
  // Returns the row whose lines contain a line of the file, for messages and the cursor of a text panel.
  [[nodiscard]] std::optional<std::size_t> find_line(int line) const;
};

// `source`: the motion as far as the compiler understood it; steps that it did not are described by their
// text. Without it the rows have no angles but those of the standing pose.
[[nodiscard]] MotionRows make_rows(const YamlNode& tree, const simulation::MotionSource* source,
                                   std::span<const simulation::Diagnostic> diagnostics,
                                   const MotionRobot& robot);

}  // namespace koboshi::studio
