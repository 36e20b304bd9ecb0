#include <string>

#include "mechanics/point_reach.h"
#include "tests/closed_loop/other_robots.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/simulation/motion_language/motion_fixture.h"

// Targets of a hand for robots with more joints between trunk and hand than the default one.
namespace koboshi::simulation {
namespace {

constexpr int kJointsOfAnArm = 3;
constexpr int kMaxJoints = static_cast<int>(mechanics::PointChain::kMaxHinges);

// The messages for a motion that moves the hand of a robot with this many joints from its trunk to that hand.
std::string messages_of_reach(int joints) {
  const test::TemporaryFolder folder;
  test::write_robot(folder.path, test::with_left_collar(test::default_robot(), joints - kJointsOfAnArm), true,
                    false);
  const NamedModel model = load_named_model(sim_board::load_robot(folder.path / "robot.sdf"));
  const MotionFile file = read_motion_text(
      "motion.yaml",
      "version: 2\nrobot: koboshi\nname: reach\n"
      "poses: {stand: {others: zero, hip_pitch: -15.9, knee: 43.7, ankle_pitch: -27.8, shoulder_roll: 8}}\n"
      "steps: [{pose: {from: stand, left_hand: {x_mm: 60, y_mm: 60, z_mm: 150}}, time_s: 1}]\n");
  Diagnostics diagnostics(file.path, file.text);
  try {
    static_cast<void>(compile_motion(parse_motion(file, model, diagnostics), model, diagnostics));
  } catch (const MotionError&) {
  }
  return print(diagnostics.all());
}

TEST(Reach, OfAHandIsSolvedWithUpToEightJoints) {
  EXPECT_EQ(messages_of_reach(kJointsOfAnArm), "");
  EXPECT_EQ(messages_of_reach(kMaxJoints), "");
}

TEST(Reach, OfAHandWithMoreJointsIsRefused) {
  EXPECT_THAT(messages_of_reach(kMaxJoints + 1), testing::HasSubstr("left_hand"));
}

}  // namespace
}  // namespace koboshi::simulation
