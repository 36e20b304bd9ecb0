#include "simulation/assembly/prepared_scenario.h"

#include <string>

#include "base/text/error.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/storage/catalogue.h"
#include "simulation/assembly/plant.h"
#include "simulation/assembly/robot_parameters.h"
#include "simulation/assembly/storage_contents.h"
#include "simulation/gait/gait_motion.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/policy/policy_file.h"
#include "simulation/scenario/reader.h"

namespace koboshi::simulation {
namespace {

// Adds a gait to the scenario: its motion, the plan as the reference for the evaluation, the gains of its
// feedback, and the initial pose of the robot.
std::vector<std::byte> compile_gait(const Gait& gait, PreparedScenario& prepared) {
  Scenario& scenario = prepared.scenario;
  const NamedModel& model = prepared.model;
  prepared.gait_plan.emplace(gait);
  const MotionSource motion = make_gait_motion(gait, prepared.robot, model);
  if (scenario.initial.joints.empty()) {
    const PoseSource& stand = motion.poses.front();
    for (std::size_t joint = 0; joint < stand.angles.size(); ++joint) {
      scenario.initial.joints.push_back(
          {{model.joint_names[joint], gait.file, 0}, fixed::to_double(*stand.angles[joint])});
    }
  }
  if (scenario.gait->feedback) {
    const auto add = [&](const char* name, double gain_s) {
      scenario.parameters.push_back({{name, gait.file, 0}, gain_s});
    };
    add("ankle_pitch_gain_s", gait.feedback.ankle_pitch_s);
    add("ankle_roll_gain_s", gait.feedback.ankle_roll_s);
    add("hip_roll_gain_s", gait.feedback.hip_roll_s);
    add("knee_gain_s", gait.feedback.knee_s);
  }
  return compile_motion(motion, model);
}

std::vector<std::vector<std::byte>> compile_motions(PreparedScenario& prepared) {
  const Scenario& scenario = prepared.scenario;
  const std::size_t count = scenario.motions.size() + (scenario.gait ? 1 : 0);
  if (count > storage::kMaxMotions) {
    throw InputError(scenario.file, 0, std::to_string(count) + " motions",
                     "at most " + std::to_string(storage::kMaxMotions) + ", a gait's included");
  }
  std::vector<std::vector<std::byte>> motions;
  for (const MotionChoice& motion : scenario.motions) {
    motions.push_back(compile_motion(motion.file, prepared.model, motion.overrides));
  }
  if (scenario.gait)
    motions.push_back(compile_gait(read_gait(scenario.gait->file, scenario.gait->overrides), prepared));
  return motions;
}

// The image of the scenario's policy; empty without one.
std::vector<std::byte> read_policy(const Scenario& scenario, const robot::RobotModel& model) {
  if (!scenario.policy) return {};
  return read_policy_image(*scenario.policy, model);
}

}  // namespace

PreparedScenario prepare(const Scenario& scenario) {
  PreparedScenario prepared{.scenario = scenario, .robot = read_robot(scenario)};
  prepared.plant = read_plant(scenario);
  prepared.model = load_named_model(prepared.robot);
  prepared.motions = compile_motions(prepared);
  prepared.parameters = compile_robot_parameters(scenario.robot_parameters, prepared.model.model);
  prepared.storage_contents =
      make_storage_contents(prepared.model.image, prepared.motions, prepared.parameters,
                            read_policy(scenario, prepared.model.model));
  return prepared;
}

PreparedScenario with_policy(PreparedScenario prepared, std::span<const std::byte> image) {
  const std::vector<std::byte> aligned(image.begin(), image.end());
  policy::Policy policy;
  const policy::PolicyVerdict verdict = policy::Policy::open(aligned, prepared.model.model, policy);
  if (!verdict.ok())
    throw InputError(prepared.scenario.file, 0, describe(verdict), "a policy for this robot");
  prepared.storage_contents =
      make_storage_contents(prepared.model.image, prepared.motions, prepared.parameters, aligned);
  return prepared;
}

}  // namespace koboshi::simulation
