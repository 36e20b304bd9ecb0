#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/edit/yaml_document.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/motion_language/parse/diagnostic.h"
#include "simulation/motion_language/parse/source.h"
#include "studio/document/motion_robot.h"
#include "studio/document/motion_rows.h"
#include "studio/document/text_document.h"

namespace koboshi::studio {

// An angle of a joint, which is given by its index.
struct JointAngle {
  std::size_t joint = 0;
  double angle_rad = 0.0;
};

// The steps that an edit of a named pose concerns: all that use the pose, or this one alone, which then gets
// a copy of the pose with a name of its own.
enum class PoseScope { kAllSteps, kThisStep };

// Where steps are inserted.
struct StepPlace {
  enum class Kind {
    kBefore,    // the row
    kAfter,     // the row, with its body
    kInto,      // at the end of the row's body: of a loop, or of a branch's `then`
    kIntoElse,  // at the end of the branch's `else`, which is added if it is missing
    kEndOf      // at the end of the section
  };

  Kind kind = Kind::kAfter;
  std::size_t index = 0;  // of the row or section
};

// A motion file that is being edited: its text, what the compiler makes of it, and the edits of a motion
// editor.
//
// Every edit is one step of the undo history and changes as few bytes as it can: comments, order and layout
// of the rest stay. An edit that does not fit throws InputError and changes nothing; so do all edits but
// replace_text while the text is no YAML. A text with errors of the motion language stays editable. Rows are
// indices into rows() of the present revision; `rows` of one edit may be in any order, and a row stands for
// its body as well. Edits with one non-empty `drag` merge into one step until end_drag() or another edit.
class MotionDocument final : public TextDocument {  // Large: one function per edit
 public:
  // Opens a file. `recovery_folder`: for autosave; empty: none. Throws InputError if the file cannot be
  // read; a file with errors opens.
  MotionDocument(std::shared_ptr<const MotionRobot> robot, const std::filesystem::path& file,
                 std::filesystem::path recovery_folder = {});
  // Begins a motion that moves to the standing pose. `name`: 1 to 24 printable ASCII letters.
  static constexpr const char* kNewName = "untitled";
  [[nodiscard]] static std::unique_ptr<MotionDocument> begin(std::shared_ptr<const MotionRobot> robot,
                                                             const std::string& name,
                                                             std::filesystem::path recovery_folder = {});
  // Opens a recovery as an unsaved document for its original file.
  [[nodiscard]] static std::unique_ptr<MotionDocument> restore(std::shared_ptr<const MotionRobot> robot,
                                                               const Recovery& recovery,
                                                               std::filesystem::path recovery_folder = {});

  const MotionRobot& robot() const { return *robot_; }
  const std::string& text() const override { return text_; }

  // The meaning of the present text. Pointers and references are valid until the next change.
  const YamlNode* tree() const;  // nullptr: no YAML
  // The source as the compiler understood it; nullptr after too many errors.
  const simulation::MotionSource* source() const;
  const simulation::CompiledMotion* compiled() const;  // nullptr: errors
  const std::vector<simulation::Diagnostic>& diagnostics() const { return diagnostics_; }
  const MotionRows& rows() const { return rows_; }  // empty: no YAML
  // The name under which a controller lists the motion; empty: the text has none.
  std::string name() const;

  // Changes the name: 1 to 24 printable ASCII letters.
  void set_name(const std::string& name);

  // Poses. Angles are rounded to 0.01 degrees within the joint's limits.
  void set_angles(std::size_t row, std::span<const JointAngle> angles, PoseScope scope,
                  std::string_view drag = {});
  // Renames a pose with all references.
  void rename_pose(const std::string& from, const std::string& to);

  // Times in s, rounded to 0.001. `set_time` replaces the speed of a move by speed, `set_speed` the time.
  void set_time(std::span<const std::size_t> rows, double time_s, std::string_view drag = {});
  void set_speed(std::span<const std::size_t> rows, double speed_deg_per_s, std::string_view drag = {});
  // A pause of 0 removes the key.
  void set_pause(std::span<const std::size_t> rows, double pause_s, std::string_view drag = {});
  // Without a value, the default of the file counts.
  void set_interpolation(std::span<const std::size_t> rows,
                         std::optional<motion::Interpolation> interpolation);
  // Multiplies the present times, pauses and time-outs, and divides speeds.
  void scale_time(std::span<const std::size_t> rows, double factor, std::string_view drag = {});
  // Sets a key of a step to a YAML value in flow style; the path begins within the step: "loop.times".
  void set_value(std::size_t row, const YamlPath& path, std::string_view value, std::string_view drag = {});
  // Removes a key of a step.
  void erase_value(std::size_t row, const YamlPath& path);

  // Steps. Insertions return the first new row.
  // `yaml`: one step in flow style, or a block list of steps (lines that begin with "- ").
  std::size_t insert_step(const StepPlace& place, std::string_view yaml);
  // Inserts a move to a new pose with the angles of all joints.
  std::size_t insert_pose(const StepPlace& place, std::span<const double> angles_rad, double time_s,
                          const std::string& pose_name = "pose");
  // Comments on lines of their own stay.
  void erase_rows(std::span<const std::size_t> rows);
  // Puts copies behind the last of the rows.
  std::size_t duplicate_rows(std::span<const std::size_t> rows);
  // The comment lines directly above a step move with it.
  std::size_t move_rows(std::span<const std::size_t> rows, const StepPlace& place);
  // Reverses moves and waits of one list. The time, speed and interpolation of a move belong to the
  // transition from the pose before, and stay with it.
  void reverse_rows(std::span<const std::size_t> rows);
  // Exchanges left and right in the rows, with new poses where the mirror image is none of the file's.
  void mirror_rows(std::span<const std::size_t> rows);
  void mirror_motion();

  // The steps as a motion file of their own, with the poses that they use.
  [[nodiscard]] std::string copy_rows(std::span<const std::size_t> rows) const;
  // Inserts copied steps. Poses that the file has already are reused, other poses with a name that is taken
  // get a new one. Throws InputError for another text, and for steps of another robot.
  std::size_t paste(const StepPlace& place, const std::string& copied);

  // Replaces the whole text, which need not be YAML.
  void replace_text(std::string text, std::string_view drag = {});
  // Converts a file of version 1 to version 2.
  void upgrade();

  // Saves to another file. A motion that still has the name of a new one, or that of its file so far, gets
  // the name of the file, without its extension, as part of the change.
  void save_as(const std::filesystem::path& file);
  // As Autosave.
  bool autosave(std::int64_t now_unix_s) { return autosave_.write(*this, now_unix_s); }
  void keep_recovery() { autosave_.keep(); }

 private:
  struct Start {
    std::filesystem::path file;
    std::string text;
    FileState disk;
  };
  MotionDocument(std::shared_ptr<const MotionRobot> robot, Start start,
                 std::filesystem::path recovery_folder);

  // Makes an edit of the YAML one change of the history.
  void edit(std::string_view label, std::string_view drag, const std::function<void(YamlDocument&)>& change);
  void check(const std::string& /*text*/) const override {}  // a text with errors can be edited
  void take_text(std::string text) override;
  void match_file() override { autosave_.match_file(file()); }
  void analyse();
  const YamlDocument& yaml() const;
  // The name of the file in messages.
  std::filesystem::path source_name() const;
  const MotionRow& row(std::size_t row) const;
  void follow_name_of(const std::filesystem::path& file);
  void require_version_2(const std::string& construct) const;

  // Index in the list of steps with this path.
  struct ListPlace {
    YamlPath list;
    std::size_t index = 0;
  };
  ListPlace find_place(const StepPlace& place) const;
  std::size_t row_at(const ListPlace& place) const;
  // Inserts a block of steps; a missing `else` becomes one.
  static void insert_steps(YamlDocument& yaml, const ListPlace& place, std::string_view block);
  YamlPath own_pose(YamlDocument& yaml, const MotionRow& row, PoseScope scope) const;
  std::vector<YamlEdit> angle_edits(const YamlDocument& yaml, const YamlPath& pose, const MotionRow& row,
                                    std::span<const JointAngle> angles) const;
  std::string mirrored_steps(const YamlDocument& yaml, const std::string& block,
                             std::map<std::string, std::string>& images, std::string& new_poses) const;

  std::shared_ptr<const MotionRobot> robot_;
  std::string text_;
  std::optional<YamlDocument> yaml_;  // none: the text is no YAML
  std::optional<simulation::MotionSource> source_;
  std::optional<simulation::CompiledMotion> compiled_;
  std::vector<simulation::Diagnostic> diagnostics_;
  MotionRows rows_;
  Autosave autosave_;
};

}  // namespace koboshi::studio
