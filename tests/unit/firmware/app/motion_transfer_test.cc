#include "firmware/app/motion_transfer.h"

#include <gtest/gtest.h>

#include "tests/support/controller_bench.h"
#include "tests/support/robot_storage.h"
#include "tests/support/sdo_pc.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::app {
namespace {

using canopen::AbortCode;
using motion::Opcode;
using test::ControllerBench;
using test::degrees;
using test::kHeadTilt;
using test::SdoPc;
using Image = std::vector<std::byte>;

constexpr canopen::ObjectAddress motion_object(std::uint8_t number) {
  return {kMotionObject, static_cast<std::uint8_t>(number + 1)};
}

class ControllerMotions : public testing::Test {
 protected:
  void SetUp() override {
    bench.board.storage.complete_after(3);
    ASSERT_TRUE(bench.run_until(State::kLimp));
  }
  // Raises the head and holds it for `poses` steps, which set the size of the image.
  Image nod(double angle_deg, std::size_t poses = 1) const {
    std::vector<fixed::Angle> pose(bench.model().joint_count);
    pose[kHeadTilt] = degrees(angle_deg);
    test::TestMotion motion{.name = "downloaded", .poses = {poses, pose}, .steps = {}};
    for (std::uint16_t i = 0; i < poses; ++i) motion.steps.push_back({Opcode::kMove, i, 200'000});
    motion.steps.push_back({Opcode::kEnd});
    return test::encode(motion, bench.model().id);
  }
  // Initiates a download of a thousand bytes to motion 7 and sends no data.
  void begin_and_stay_silent() {
    bench.board.can.deliver(
        {.identifier = 0x601, .size = 8, .data = {0xC6, 0x00, 0x24, 8, 0xE8, 0x03, 0, 0}});
    bench.run_ms(100);
  }
  double head_deg() const { return fixed::to_double(bench.target(kHeadTilt)) / test::kRadPerDegree; }

  ControllerBench bench;
  SdoPc pc{bench};
};

TEST_F(ControllerMotions, DownloadedByBlocksArePlayedAndKept) {
  ASSERT_EQ(bench.values().diagnosis.motions, 0b11u);
  const Image image = nod(15);
  ASSERT_EQ(pc.download_blocks(motion_object(7), image), AbortCode::kNone);
  EXPECT_EQ(bench.values().diagnosis.motions, 0b1000'0011u);
  EXPECT_EQ(pc.upload(motion_object(7)), image);
  bench.restart();
  ASSERT_TRUE(bench.run_until_standing());
  EXPECT_EQ(bench.values().diagnosis.motions, 0b1000'0011u);
  bench.command(Command::kPlay, 7);
  ASSERT_EQ(bench.now().state, State::kMotion);
  ASSERT_TRUE(bench.run_until(State::kStanding, 400));
  EXPECT_NEAR(head_deg(), test::stored_deg(15), 1e-3);
}

TEST_F(ControllerMotions, LongOnesAreWrittenDirectlyToSlowFlash) {
  for (const int polls : {0, 1, 3, 5, 9}) {
    bench.board.storage.complete_after(polls);
    const Image image = nod(10 + polls, 130);
    ASSERT_GT(image.size(), 5'500u);
    ASSERT_EQ(pc.download_blocks(motion_object(2), image), AbortCode::kNone) << polls;
    EXPECT_EQ(pc.upload(motion_object(2)), image) << polls;
  }
}

TEST_F(ControllerMotions, MayBeDownloadedBySegments) {
  const Image image = nod(15, 10);
  ASSERT_EQ(pc.download(motion_object(31), image), AbortCode::kNone);
  EXPECT_EQ(pc.upload(motion_object(31)), image);
}

TEST_F(ControllerMotions, ReplaceFactoryMotions) {
  ASSERT_FALSE(pc.upload(motion_object(1)).empty());
  const Image image = nod(15);
  ASSERT_EQ(pc.download_blocks(motion_object(1), image), AbortCode::kNone);
  EXPECT_EQ(pc.upload(motion_object(1)), image);
}

TEST_F(ControllerMotions, InvalidOnesKeepTheOldOne) {
  const Image image = nod(15);
  ASSERT_EQ(pc.download_blocks(motion_object(7), image), AbortCode::kNone);
  Image damaged = nod(10);
  damaged.back() ^= std::byte{1};
  EXPECT_EQ(pc.download_blocks(motion_object(7), damaged), AbortCode::kInvalidValue);
  EXPECT_EQ(pc.download_blocks(motion_object(8), damaged), AbortCode::kInvalidValue);
  const Image whole = nod(10);
  EXPECT_EQ(pc.download(motion_object(7), std::span(whole).first(20)), AbortCode::kInvalidValue);
  EXPECT_EQ(pc.upload(motion_object(7)), image);
  EXPECT_EQ(bench.values().diagnosis.motions, 0b1000'0011u);
}

TEST_F(ControllerMotions, MustBeAsLongAsTheirHeadersState) {
  const Image image = nod(15);
  ASSERT_EQ(pc.download_blocks(motion_object(7), image), AbortCode::kNone);
  for (const std::size_t size : {image.size() - 1, image.size() + 1, image.size() + 8, image.size() + 500}) {
    Image other = nod(10);
    other.resize(size, std::byte{0xFF});
    EXPECT_EQ(pc.download_blocks(motion_object(7), other), AbortCode::kInvalidValue) << size;
    EXPECT_EQ(pc.download(motion_object(8), other), AbortCode::kInvalidValue) << size;
  }
  EXPECT_EQ(pc.upload(motion_object(7)), image);
  EXPECT_EQ(bench.values().diagnosis.motions, 0b1000'0011u);
}

// The controller answers an expedited transfer but erases no flash for data too short for a motion.
TEST_F(ControllerMotions, AreRefusedAtOnceWhenOfAFewBytes) {
  const Image storage(bench.board.storage.contents().begin(), bench.board.storage.contents().end());
  for (const std::size_t size : {std::size_t{1}, std::size_t{4}}) {
    EXPECT_EQ(pc.write(motion_object(2), 0x55, size), AbortCode::kLengthTooLow);
    EXPECT_EQ(pc.answer_ms, 1);
  }
  EXPECT_EQ(pc.download(motion_object(2), {}), AbortCode::kLengthTooLow);
  EXPECT_EQ(pc.download_blocks(motion_object(2), {}), AbortCode::kLengthTooLow);
  // Four bytes without a size indication.
  bench.board.can.deliver({.identifier = 0x601, .size = 8, .data = {0x22, 0x00, 0x24, 3, 0x55}});
  bench.run_ms(1);
  EXPECT_EQ(canopen::load_u32(&bench.last_sent(0x581)->data[4]), 0x0607'0013u);
  bench.run_ms(100);
  EXPECT_TRUE(std::ranges::equal(storage, bench.board.storage.contents()));
  EXPECT_EQ(pc.download_blocks(motion_object(2), nod(15)), AbortCode::kNone);
}

TEST_F(ControllerMotions, AreRefusedUnlessTheRobotStandsOrIsLimp) {
  bench.run_ms(20);
  bench.command(Command::kEnable);
  EXPECT_EQ(pc.download_blocks(motion_object(7), nod(15)), AbortCode::kDeviceState);
  ASSERT_TRUE(bench.run_until(State::kStanding));
  bench.command(Command::kPlay, 1);
  EXPECT_EQ(pc.download_blocks(motion_object(7), nod(15)), AbortCode::kDeviceState);
  EXPECT_FALSE(pc.upload(motion_object(1)).empty());  // reading is permitted
  bench.command(Command::kStop);
  ASSERT_TRUE(bench.run_until(State::kStanding));
  EXPECT_EQ(pc.download_blocks(motion_object(7), nod(15)), AbortCode::kNone);
}

TEST_F(ControllerMotions, AreRefusedWhenTooLongOrUnknown) {
  EXPECT_EQ(pc.download_blocks(motion_object(7), Image(storage::kRobotLayout.max_item_size_bytes() + 1)),
            AbortCode::kLengthTooHigh);
  pc.upload(motion_object(7));
  EXPECT_EQ(pc.refusal, AbortCode::kNoData);
  EXPECT_EQ(pc.download_blocks(motion_object(32), nod(15)), AbortCode::kSubindexDoesNotExist);
}

TEST_F(ControllerMotions, AbortedDownloadsKeepTheOldOneAndAllowANewDownload) {
  const Image image = nod(15);
  ASSERT_EQ(pc.download_blocks(motion_object(7), image), AbortCode::kNone);
  begin_and_stay_silent();
  bench.run_ms(1'200);  // the server's time-out for the client expires
  EXPECT_EQ(pc.upload(motion_object(7)), image);
  EXPECT_EQ(pc.save(), AbortCode::kNone);
  EXPECT_EQ(pc.download_blocks(motion_object(7), nod(10)), AbortCode::kNone);
}

TEST_F(ControllerMotions, DoNotMixWithParametersOfAnotherClient) {
  ASSERT_EQ(pc.write({0x1201, 1}, 0x681, 4), AbortCode::kNone);
  ASSERT_EQ(pc.write({0x1201, 2}, 0x6C1, 4), AbortCode::kNone);
  begin_and_stay_silent();
  bench.board.can.deliver(
      {.identifier = 0x681, .size = 8, .data = {0x23, 0x10, 0x10, 1, 0x73, 0x61, 0x76, 0x65}});
  bench.run_ms(10);
  const auto answer = bench.last_sent(0x6C1);
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(canopen::load_u32(&answer->data[4]), 0x0800'0022u);
}

}  // namespace
}  // namespace koboshi::app
