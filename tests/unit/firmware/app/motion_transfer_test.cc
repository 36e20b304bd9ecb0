#include "firmware/app/motion_transfer.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "firmware/storage/image.h"
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

constexpr canopen::ObjectAddress name_object(std::uint8_t number) {
  return {kMotionNameObject, static_cast<std::uint8_t>(number + 1)};
}

constexpr canopen::ObjectAddress crc_object(std::uint8_t number) {
  return {kMotionCrcObject, static_cast<std::uint8_t>(number + 1)};
}

class ControllerMotions : public testing::Test {
 protected:
  void SetUp() override {
    bench.board.storage.complete_after(3);
    ASSERT_TRUE(bench.run_until(State::kLimp));
  }
  // Raises the head and holds it, or moves it on, for `poses` steps, which set the size of the image.
  Image nod(double angle_deg, std::size_t poses = 1, double step_deg = 0) const {
    std::vector<fixed::Angle> pose(bench.model().joint_count);
    test::TestMotion motion{.name = "downloaded", .poses = {poses, pose}, .steps = {}};
    for (std::uint16_t i = 0; i < poses; ++i) {
      motion.poses[i][kHeadTilt] = degrees(angle_deg + i * step_deg);
      motion.steps.push_back({Opcode::kMove, i, 200'000});
    }
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
  ASSERT_EQ(bench.values().diagnosis.motions[0], 0b11u);
  const Image image = nod(15);
  ASSERT_EQ(pc.download_blocks(motion_object(7), image), AbortCode::kNone);
  EXPECT_EQ(bench.values().diagnosis.motions[0], 0b1000'0011u);
  EXPECT_EQ(pc.upload(motion_object(7)), image);
  bench.restart();
  ASSERT_TRUE(bench.run_until_standing());
  EXPECT_EQ(bench.values().diagnosis.motions[0], 0b1000'0011u);
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

// A list of the motions needs no transfer of the images.
TEST_F(ControllerMotions, AreListedWithNameAndCrc) {
  const Image image = nod(15);
  ASSERT_EQ(pc.download_blocks(motion_object(199), image), AbortCode::kNone);
  EXPECT_EQ(bench.values().diagnosis.motions[6], 1u << 199 % 32);
  EXPECT_EQ(pc.read({0x2403, 7}), 1u << 199 % 32);
  EXPECT_EQ(pc.read({0x2403, 1}), 0b11u);
  const Image name = pc.upload(name_object(199));
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(name.data()), name.size()), "downloaded");
  EXPECT_EQ(pc.read(crc_object(199)), storage::image_crc32(image));
  EXPECT_TRUE(pc.upload(name_object(198)).empty());
  EXPECT_EQ(pc.refusal, AbortCode::kNoData);
  const std::uint32_t free = pc.read({kFreeStorageObject, 0});
  EXPECT_LT(free, storage::kRobotLogSize_bytes - 2 * image.size());
  ASSERT_EQ(pc.download_blocks(motion_object(198), image), AbortCode::kNone);
  EXPECT_EQ(pc.read({kFreeStorageObject, 0}),
            free - storage::ItemStore::kHeaderSize - (image.size() + 7) / 8 * 8);
}

TEST_F(ControllerMotions, AreErasedByWritingTheirCrc) {
  const Image factory = pc.upload(motion_object(1));
  ASSERT_FALSE(factory.empty());
  for (const std::uint8_t number : {std::uint8_t{1}, std::uint8_t{150}})
    ASSERT_EQ(pc.download_blocks(motion_object(number), nod(15)), AbortCode::kNone);
  EXPECT_EQ(pc.write(crc_object(1), 7, 4), AbortCode::kInvalidValue);
  EXPECT_EQ(pc.upload(motion_object(1)), nod(15));
  for (int i = 0; i < 2; ++i) {  // the second time there is nothing to do
    EXPECT_EQ(pc.write(crc_object(1), 0, 4), AbortCode::kNone);
    EXPECT_EQ(pc.write(crc_object(150), 0, 4), AbortCode::kNone);
    EXPECT_EQ(pc.upload(motion_object(1)), factory);
    EXPECT_TRUE(pc.upload(motion_object(150)).empty());
    EXPECT_EQ(bench.values().diagnosis.motions[0], 0b11u);
    EXPECT_EQ(bench.values().diagnosis.motions[4], 0u);
  }
  bench.restart();
  bench.run_ms(10);
  EXPECT_EQ(bench.values().diagnosis.motions[0], 0b11u);
}

// The motion that is played is replaced and erased, and the log around it is filled, until only its own place
// is left: its targets stay the same.
TEST_F(ControllerMotions, PlayTheSameWhateverIsStoredMeanwhile) {
  using Target = std::pair<std::uint64_t, std::array<std::uint8_t, 8>>;
  const auto play = [this](bool stores) {
    ControllerBench own;
    SdoPc client(own);
    own.board.storage.complete_after(3);
    EXPECT_TRUE(own.run_until(State::kLimp));
    EXPECT_EQ(client.download_blocks(motion_object(7), nod(-5, 65, 0.3)), AbortCode::kNone);
    EXPECT_TRUE(own.run_until_standing());
    const std::uint64_t start_us = own.now_us();
    own.command(Command::kPlay, 7);
    EXPECT_EQ(own.now().state, State::kMotion);
    int refused = 0;
    for (int i = 0; stores && own.now_us() < start_us + 12'000'000; ++i) {
      const auto number = static_cast<std::uint8_t>(7 + i % 3);
      if (i % 5 == 4) static_cast<void>(client.write(crc_object(number), 0, 4));
      const AbortCode code = client.download_blocks(motion_object(number), nod(i % 30, 64));
      EXPECT_TRUE(code == AbortCode::kNone || code == AbortCode::kDeviceState) << i;
      refused += code == AbortCode::kNone ? 0 : 1;
    }
    EXPECT_EQ(refused > 0, stores);
    // The client keeps the frames of its last transfer only, which show where the motion is.
    own.sent.clear();
    while (own.now_us() < start_us + 12'900'000) own.run_ms(1);
    EXPECT_EQ(own.now().state, State::kMotion);
    while (own.now_us() < start_us + 14'000'000) own.run_ms(1);
    EXPECT_EQ(own.now().state, State::kStanding);
    std::vector<Target> targets;
    for (const auto& [time_us, frame] : own.sent) {
      if (frame.identifier >= 0x210 && frame.identifier < 0x230)
        targets.emplace_back(time_us - start_us, frame.data);
    }
    return targets;
  };
  const std::vector<Target> alone = play(false);
  const std::vector<Target> beside = play(true);
  ASSERT_GT(beside.size(), 1'000u);
  EXPECT_TRUE(std::ranges::equal(beside, std::span(alone).last(beside.size())));
}

// A motion that loops stays where it is in the log, so that compaction cannot pass it. A download then fails
// with a refusal instead of waiting for ever, and succeeds once the motion has stopped.
TEST_F(ControllerMotions, AreRefusedWhileALoopBlocksTheirPlaceAndAcceptedAfterwards) {
  std::vector<fixed::Angle> pose(bench.model().joint_count);
  const test::TestMotion loop{
      .name = "loop",
      .poses = {pose},
      .steps = {{Opcode::kLoopBegin}, {Opcode::kMove, 0, 50'000}, {Opcode::kLoopEnd}, {Opcode::kEnd}}};
  ASSERT_EQ(pc.download_blocks(motion_object(7), test::encode(loop, bench.model().id)), AbortCode::kNone);
  ASSERT_TRUE(bench.run_until_standing());
  bench.command(Command::kPlay, 7);
  ASSERT_EQ(bench.now().state, State::kMotion);
  AbortCode code = AbortCode::kNone;
  for (int i = 0; code == AbortCode::kNone && i < 200; ++i)
    code = pc.download_blocks(motion_object(8), nod(i % 30, 64));
  EXPECT_EQ(code, AbortCode::kDeviceState);
  EXPECT_EQ(bench.now().state, State::kMotion);
  bench.command(Command::kStop);
  ASSERT_TRUE(bench.run_until(State::kStanding, 500));
  EXPECT_EQ(pc.download_blocks(motion_object(8), nod(20, 64)), AbortCode::kNone);
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
  EXPECT_EQ(bench.values().diagnosis.motions[0], 0b1000'0011u);
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
  EXPECT_EQ(bench.values().diagnosis.motions[0], 0b1000'0011u);
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

TEST_F(ControllerMotions, AreRefusedWhileTheRobotStartsOrWalks) {
  bench.run_ms(1'200);  // of rest, for the gyro's bias
  bench.command(Command::kEnable);
  EXPECT_EQ(pc.download_blocks(motion_object(7), nod(15)), AbortCode::kDeviceState);
  ASSERT_TRUE(bench.run_until(State::kStanding));
  bench.command(Command::kWalk);
  ASSERT_EQ(bench.now().state, State::kWalking);
  EXPECT_EQ(pc.download_blocks(motion_object(7), nod(15)), AbortCode::kDeviceState);
  EXPECT_EQ(pc.write(crc_object(1), 0, 4), AbortCode::kDeviceState);
  EXPECT_FALSE(pc.upload(motion_object(1)).empty());  // reading is permitted
  bench.command(Command::kStop);
  ASSERT_TRUE(bench.run_until(State::kStanding));
  EXPECT_EQ(pc.download_blocks(motion_object(7), nod(15)), AbortCode::kNone);
}

TEST_F(ControllerMotions, AreRefusedWhenTooLongOrUnknown) {
  EXPECT_EQ(pc.download_blocks(motion_object(7), Image(storage::ItemStore::kMaxItemSize_bytes + 1)),
            AbortCode::kLengthTooHigh);
  pc.upload(motion_object(7));
  EXPECT_EQ(pc.refusal, AbortCode::kNoData);
  EXPECT_EQ(pc.download_blocks({kMotionObject, 201}, nod(15)), AbortCode::kSubindexDoesNotExist);
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
