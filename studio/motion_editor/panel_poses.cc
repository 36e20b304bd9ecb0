#include <QTableView>
#include <algorithm>
#include <cmath>
#include <string>

#include "base/text/error.h"
#include "studio/motion_editor/joint_panel.h"
#include "studio/motion_editor/motion_panel.h"

// Poses that come from the view: dragged ones, those of a run, and those from which a motion is played.
namespace koboshi::studio {
namespace {

constexpr double kInsertedTime_s = 0.5;
constexpr std::uint64_t kTick_us = 10'000;  // of the check, and of a preview
constexpr double kApproach_s = 1.5;         // to the pose before the first step that is played

}  // namespace

std::optional<std::size_t> MotionPanel::current_row() const {
  const QModelIndex current = table_->currentIndex();
  if (!editor_->is_open() || !current.isValid()) return std::nullopt;
  const auto row = static_cast<std::size_t>(current.row());
  return row < editor_->rows().rows.size() ? std::optional(row) : std::nullopt;
}

std::vector<double> MotionPanel::editable_pose() const {
  const auto row = current_row();
  if (!row || editor_->rows().rows[*row].kind != simulation::StepSource::Kind::kMove) return {};
  return editor_->rows().rows[*row].angles_rad;
}

bool MotionPanel::drag_pose(std::span<const JointAngle> angles) {
  const auto row = current_row();
  if (!row) return false;
  const std::string drag = "view " + std::to_string(*row);
  return editor_->edit(
      [&](MotionDocument& document) { document.set_angles(*row, angles, joints_->scope(), drag); });
}

void MotionPanel::end_pose_drag() { editor_->end_drag(); }

void MotionPanel::insert_pose(std::span<const double> angles_rad, const std::string& name) {
  add_steps([&](MotionDocument& document, const StepPlace& place) {
    return document.insert_pose(place, angles_rad, kInsertedTime_s, name);
  });
}

std::uint64_t MotionPanel::start_us(std::size_t row) const {
  const auto& rows = editor_->rows().rows;
  if (row >= rows.size() || rows[row].section != 0) return 0;
  return static_cast<std::uint64_t>(std::llround(1e6 * rows[row].start_s));
}

std::uint64_t MotionPanel::preview_start_us(std::size_t row) const {
  return scrubbed_tick_ ? *scrubbed_tick_ * kTick_us : start_us(row);
}

std::string MotionPanel::text_from(std::size_t row) const {
  const auto& rows = editor_->rows().rows;
  if (row >= rows.size() || rows[row].section != 0) return text();
  while (rows[row].parent) row = *rows[row].parent;
  if (row == 0) return text();
  const auto document =
      MotionDocument::restore(std::make_shared<const MotionRobot>(editor_->document().robot()),
                              Recovery{.recovery_file = {}, .original = {}, .text = text()});
  const std::vector<double> before = rows[row - 1].angles_rad;
  document->insert_pose({StepPlace::Kind::kBefore, row}, before, kApproach_s, "start");
  std::vector<std::size_t> played_before;
  for (std::size_t i = 0; i < row; ++i) played_before.push_back(i);
  document->erase_rows(played_before);
  return document->text();
}

}  // namespace koboshi::studio
