#include "studio/document/motion_robot.h"

#include "sim_board/description/load.h"
#include "simulation/motion_language/parse/parse.h"
#include "studio/document/motion_rows.h"

namespace koboshi::studio {

std::shared_ptr<const MotionRobot> load_motion_robot(const std::filesystem::path& robot_file) {
  return load_motion_robot(
      std::make_shared<const sim_board::RobotDescription>(sim_board::load_robot(robot_file)));
}

std::shared_ptr<const MotionRobot> load_motion_robot(
    std::shared_ptr<const sim_board::RobotDescription> description) {
  auto robot = std::make_shared<MotionRobot>();
  robot->description = std::move(description);
  robot->model = simulation::load_named_model(*robot->description);
  robot->standing_rad.assign(robot->model.joint_names.size(), 0.0);
  const std::filesystem::path stand = robot->description->file.parent_path() / "motions" / "stand.yaml";
  if (!std::filesystem::exists(stand)) return robot;
  const simulation::MotionFile file = simulation::read_motion_file(stand);
  const simulation::MotionSource source = simulation::parse_motion(stand, robot->model);
  const MotionRows rows = make_rows(file.tree, &source, {}, *robot);
  const MotionSection& program = rows.sections.front();
  if (program.row_count > 0) robot->standing_rad = rows.rows[program.row_count - 1].angles_rad;
  return robot;
}

}  // namespace koboshi::studio
