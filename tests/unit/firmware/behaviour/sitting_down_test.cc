// Sitting down, source by source: what the robot does ends first, then the motion plays.

#include "firmware/behaviour/sitting_down.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "hal/fake/storage.h"
#include "tests/support/factory_values.h"
#include "tests/support/robot_storage.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::behaviour {
namespace {

constexpr std::uint32_t kCycle_us = 10'000;
constexpr int kSitTicks = 20;

// A source that ends a number of cycles after it was told to.
class EndingSource final : public MotionSource {
 public:
  explicit EndingSource(int cycles) : cycles_(cycles) {}

  void advance(std::uint32_t elapsed_us, const motion::Inputs& inputs,
               std::span<fixed::Angle> targets) override {
    EXPECT_GT(cycles_, 0) << "it has ended";
    EXPECT_EQ(elapsed_us, kCycle_us);
    EXPECT_EQ(inputs.supply_mV, 6'000u);
    targets[0] = test::degrees(5);
    if (stopped) --cycles_;
  }
  void stop() override { stopped = true; }
  void abort() override { cycles_ = 0; }
  [[nodiscard]] bool running() const override { return cycles_ > 0; }
  [[nodiscard]] Plan plan() const override {
    return {.lean = {}, .pitch = test::degrees(3), .feedback = balance::FeedbackMode::kWalking};
  }

  bool stopped = false;

 private:
  int cycles_;
};

class SittingDownTest : public testing::Test {
 protected:
  SittingDownTest() { give({{motion::Opcode::kEnd}}); }

  // Stores a motion that moves the knee by 40 degrees in kSitTicks and ends by these steps.
  void give(const std::vector<motion::Step>& last_steps, motion::Role role = motion::Role::kSit) {
    const std::vector<std::byte> image = test::encode(test::make_test_robot());
    static_cast<void>(robot::load_model(image, model));
    std::vector<fixed::Angle> pose(model.joint_count);
    pose[test::kKnee] = test::degrees(40);
    test::TestMotion motion{.name = std::string(motion::kMotionNames[static_cast<std::size_t>(role)]),
                            .poses = {pose},
                            .steps = {{motion::Opcode::kMove, 0, kSitTicks * kCycle_us}}};
    motion.steps.insert(motion.steps.end(), last_steps.begin(), last_steps.end());
    flash.load(0,
               test::make_storage(image, std::vector<std::vector<std::byte>>{test::encode(motion, model.id)},
                                  test::encode(test::factory_values(), model.id)));
    catalogue.emplace(flash.contents());
    items.emplace(flash, storage::kRobotLogSize_bytes);
    motions.load();
  }
  // Returns the number of cycles until it ends, at most 100.
  int run() {
    int cycles = 0;
    while (sitting_down.running() && cycles < 100) {
      advance();
      ++cycles;
    }
    return cycles;
  }
  void advance() {
    sitting_down.advance(kCycle_us, {.robot = robot, .supply_mV = 6'000}, {angles.data(), model.joint_count});
  }

  robot::RobotModel model = test::make_test_robot();
  hal::FakeStorage flash;
  std::optional<storage::Catalogue> catalogue{std::in_place, std::span<const std::byte>()};
  std::optional<storage::ItemStore> items{std::in_place, flash, storage::kRobotLogSize_bytes};
  motion::MotionLibrary motions{*catalogue, *items, model};
  RecoveryParameters parameters = test::kTestRecovery;
  MotionPlayer player{model, motions, parameters};
  SittingDown sitting_down{player};
  estimation::RobotState robot;
  std::array<fixed::Angle, robot::kMaxJoints> angles{};
};

TEST_F(SittingDownTest, DoesNothingBeforeItBegins) {
  EXPECT_FALSE(sitting_down.running());
  advance();
  EXPECT_FALSE(sitting_down.running() || sitting_down.done() || player.running());
}

TEST_F(SittingDownTest, PlaysItsMotionFromStanding) {
  sitting_down.begin(nullptr);
  EXPECT_TRUE(sitting_down.running());
  EXPECT_FALSE(player.running());
  EXPECT_EQ(sitting_down.plan().feedback, balance::FeedbackMode::kStanding);
  advance();
  EXPECT_TRUE(player.running());
  EXPECT_EQ(sitting_down.plan().feedback, balance::FeedbackMode::kMotion);
  EXPECT_EQ(run(), kSitTicks);
  EXPECT_TRUE(sitting_down.done());
  EXPECT_NEAR(fixed::to_double(angles[test::kKnee]), 40 * test::kRadPerDegree, 3e-4);
}

TEST_F(SittingDownTest, EndsWhatTheRobotDoesBefore) {
  EndingSource last(3);
  sitting_down.begin(&last);
  EXPECT_TRUE(last.stopped);
  for (int i = 0; i < 2; ++i) {
    advance();
    EXPECT_TRUE(last.running());
    EXPECT_FALSE(player.running());
    EXPECT_EQ(sitting_down.plan().pitch, test::degrees(3)) << "the plan of the source";
    EXPECT_EQ(angles[0], test::degrees(5));
  }
  advance();
  EXPECT_FALSE(last.running());
  EXPECT_TRUE(player.running()) << "in the same cycle";
  EXPECT_EQ(sitting_down.plan().pitch, fixed::Angle());
  EXPECT_EQ(run(), kSitTicks);
  EXPECT_TRUE(sitting_down.done());
}

TEST_F(SittingDownTest, DoesNotAdvanceASourceThatHasEnded) {
  EndingSource last(0);
  sitting_down.begin(&last);
  advance();
  EXPECT_TRUE(player.running());
}

TEST_F(SittingDownTest, DoesNotStopHalfWay) {
  sitting_down.begin(nullptr);
  advance();
  sitting_down.stop();
  EXPECT_EQ(run(), kSitTicks);
  EXPECT_TRUE(sitting_down.done());
}

TEST_F(SittingDownTest, IsNotDoneIfItsMotionFails) {
  give({{motion::Opcode::kFail}, {motion::Opcode::kEnd}});
  sitting_down.begin(nullptr);
  EXPECT_EQ(run(), 1 + kSitTicks);
  EXPECT_FALSE(sitting_down.done());
}

TEST_F(SittingDownTest, EndsAtOnceWithoutAMotion) {
  give({{motion::Opcode::kEnd}}, motion::Role::kRiseProne);
  sitting_down.begin(nullptr);
  EXPECT_EQ(run(), 1);
  EXPECT_FALSE(sitting_down.done());
}

TEST_F(SittingDownTest, ForgetsItsSourceAndItsEndWhenItIsAborted) {
  EndingSource last(3);
  sitting_down.begin(&last);
  advance();
  sitting_down.abort();
  EXPECT_FALSE(sitting_down.running());
  EXPECT_EQ(sitting_down.plan().pitch, fixed::Angle());
  sitting_down.begin(nullptr);
  run();
  ASSERT_TRUE(sitting_down.done());
  sitting_down.abort();
  EXPECT_FALSE(sitting_down.done());
}

TEST_F(SittingDownTest, BeginsAnew) {
  sitting_down.begin(nullptr);
  run();
  ASSERT_TRUE(sitting_down.done());
  sitting_down.begin(nullptr);
  EXPECT_FALSE(sitting_down.done());
  EXPECT_EQ(run(), 1 + kSitTicks);
  EXPECT_TRUE(sitting_down.done());
}

}  // namespace
}  // namespace koboshi::behaviour
