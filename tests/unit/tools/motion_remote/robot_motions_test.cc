#include "tools/motion_remote/robot_motions.h"

#include <gtest/gtest.h>

#include <deque>

#include "firmware/canopen/frame.h"
#include "firmware/storage/image.h"
#include "tests/support/bus_bench.h"
#include "tests/support/robot_storage.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::tools {
namespace {

// The bus of a bench: its time goes on while somebody waits for a frame.
class BenchTransport final : public sim_board::Transport {
 public:
  explicit BenchTransport(test::BusBench& bench) : bench_(bench) {}

  bool send(const hal::CanFrame& frame, std::uint64_t) override {
    bench_.say(frame);
    return true;
  }
  std::optional<hal::CanFrame> receive() override {
    if (received_.empty()) {
      bench_.seen.clear();
      bench_.run_ms(1);
      for (const auto& seen : bench_.seen) received_.push_back(seen.frame);
      return std::nullopt;
    }
    const hal::CanFrame frame = received_.front();
    received_.pop_front();
    return frame;
  }
  std::string place() const override { return "a bench"; }

 private:
  test::BusBench& bench_;
  std::deque<hal::CanFrame> received_;
};

class RobotMotionsTest : public testing::Test {
 protected:
  // The image of a motion that turns one joint.
  std::vector<std::uint8_t> image(const std::string& name, std::size_t joint) const {
    std::vector<fixed::Angle> pose(bench.model().joint_count);
    pose[joint] = test::degrees(10);
    const test::TestMotion motion{
        .name = name,
        .poses = {pose},
        .steps = {{.opcode = motion::Opcode::kMove, .value = 200'000}, {.opcode = motion::Opcode::kEnd}}};
    const std::vector<std::byte> bytes = test::encode(motion, bench.model().id);
    const auto* first = reinterpret_cast<const std::uint8_t*>(bytes.data());
    return {first, first + bytes.size()};
  }
  static std::string message_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }

  test::BusBench bench;
  BenchTransport transport{bench};
  RobotMotions motions{transport};
};

TEST_F(RobotMotionsTest, ListsNumberNameAndCrc) {
  ASSERT_TRUE(bench.run_until_standing());
  const auto listed = motions.list();
  ASSERT_EQ(listed.size(), 2u);
  EXPECT_EQ(listed[0].name, "stand");
  EXPECT_EQ(listed[1].number, 1);
  EXPECT_EQ(listed[1].name, "nod");
  const auto nod = motions.download(1);
  EXPECT_EQ(listed[1].crc32, canopen::load_u32(&nod[storage::kImageCrcOffset]));
}

TEST_F(RobotMotionsTest, FindsByNumberOrName) {
  ASSERT_TRUE(bench.run_until_standing());
  EXPECT_EQ(motions.find("nod"), 1);
  EXPECT_EQ(motions.find("0"), 0);
  EXPECT_EQ(message_of([&] { motions.find("bow"); }),
            "found no motion bow on the robot, expected one of 0 stand, 1 nod");
}

TEST_F(RobotMotionsTest, AMotionTakesTheNumberOfItsNameOrTheLowestFreeOne) {
  ASSERT_TRUE(bench.run_until_standing());
  EXPECT_EQ(motions.number_for("nod"), 1);
  EXPECT_EQ(motions.number_for("bow"), 2);
}

TEST_F(RobotMotionsTest, WhatIsUploadedComesBackAndPlays) {
  ASSERT_TRUE(bench.run_until_standing());
  const auto bow = image("bow", 3);
  motions.upload(2, bow);
  EXPECT_EQ(motions.download(2), bow);
  EXPECT_EQ(motions.list().at(2).name, "bow");
  motions.play(2);
  EXPECT_EQ(bench.controller().state(), behaviour::State::kStanding);
  EXPECT_EQ(bench.controller().values().behaviour.motion, 2);
}

TEST_F(RobotMotionsTest, AnImageThatTheRobotRefusesIsAnError) {
  ASSERT_TRUE(bench.run_until_standing());
  auto damaged = image("bow", 3);
  damaged.back() ^= 1;
  EXPECT_NE(message_of([&] { motions.upload(2, damaged); }), "");
  EXPECT_EQ(motions.list().size(), 2u);
}

TEST_F(RobotMotionsTest, ARefusalNamesStateAndReason) {
  ASSERT_TRUE(bench.run_until(behaviour::State::kLimp));
  EXPECT_EQ(message_of([&] { motions.play(0); }), "the robot refuses in state limp: not in this state");
}

TEST_F(RobotMotionsTest, ASilentControllerIsAnError) {
  bench.controller().runs = false;
  EXPECT_EQ(message_of([&] { motions.play(0); }), "no telemetry from the controller within a second");
}

}  // namespace
}  // namespace koboshi::tools
