#include "simulation/scenario/object_access.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "firmware/canopen/sdo/protocol.h"

namespace koboshi::simulation {
namespace {

using canopen::AbortCode;
namespace sdo = canopen::sdo;

constexpr canopen::ObjectAddress kObject{0x2101, 3};
constexpr std::uint8_t kDrive = 19;
constexpr std::uint8_t kController = 1;

struct Sent final : canopen::FrameSink {
  bool send(const hal::CanFrame& frame) override {
    frames.push_back(frame);
    return true;
  }
  std::vector<hal::CanFrame> frames;
};

class ObjectAccessTest : public testing::Test {
 protected:
  Sent sent;
  ObjectAccess access{sent};

  hal::CanFrame answer(std::uint16_t identifier, const sdo::Data& data) {
    return {.identifier = identifier, .size = 8, .data = data};
  }
};

TEST_F(ObjectAccessTest, ReadsFourBytesOfTheController) {
  access.request({.number = 7, .node_id = kController, .address = kObject});
  access.process(0);
  ASSERT_EQ(sent.frames.size(), 1U);
  EXPECT_EQ(sent.frames[0].identifier, 0x601);
  EXPECT_EQ(sent.frames[0].data, (sdo::Data{0x40, 0x01, 0x21, 0x03, 0, 0, 0, 0}));
  EXPECT_TRUE(access.on_frame(
      answer(0x581, sdo::message(sdo::expedited(sdo::kInitiateUploadResponse, 2), kObject, 0x1234)), 500));
  const auto answers = access.take_answers();
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].number, 7U);
  EXPECT_EQ(answers[0].time_us, 500U);
  EXPECT_EQ(answers[0].abort, AbortCode::kNone);
  EXPECT_EQ(answers[0].data, (std::vector<std::uint8_t>{0x34, 0x12}));
  EXPECT_FALSE(access.busy());
  EXPECT_TRUE(access.take_answers().empty());
}

TEST_F(ObjectAccessTest, UsesADrivesSecondChannel) {
  access.request({.number = 1, .node_id = kDrive, .address = kObject, .data = {0xFE, 0xFF}});
  access.process(0);
  EXPECT_EQ(sent.frames.at(0).identifier, 0x680 + kDrive);
  EXPECT_EQ(sent.frames.at(0).data, (sdo::Data{0x2B, 0x01, 0x21, 0x03, 0xFE, 0xFF, 0, 0}));
  EXPECT_FALSE(
      access.on_frame(answer(0x580 + kDrive, sdo::message(sdo::kInitiateDownloadResponse, kObject, 0)), 1));
  EXPECT_TRUE(
      access.on_frame(answer(0x694 + kDrive, sdo::message(sdo::kInitiateDownloadResponse, kObject, 0)), 1));
  EXPECT_EQ(access.take_answers().at(0).abort, AbortCode::kNone);
}

TEST_F(ObjectAccessTest, ReadsATextBySegments) {
  access.request({.number = 1, .node_id = kController, .address = {0x1008, 0}});
  access.process(0);
  access.on_frame(answer(0x581, sdo::message(sdo::kInitiateUploadResponse | 1, {0x1008, 0}, 9)), 1);
  ASSERT_EQ(sent.frames.size(), 2U);
  EXPECT_EQ(sent.frames[1].data[0], 0x60);
  access.on_frame(answer(0x581, {0x00, 'K', 'o', 'b', 'o', 's', 'h', 'i'}), 2);
  ASSERT_EQ(sent.frames.size(), 3U);
  EXPECT_EQ(sent.frames[2].data[0], 0x70);
  access.on_frame(answer(0x581, {0x10 | (5 << 1) | 1, ' ', '1', 0, 0, 0, 0, 0}), 3);
  const auto answers = access.take_answers();
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(std::string(answers[0].data.begin(), answers[0].data.end()), "Koboshi 1");
}

// CiA 301, 7.2.4.3.3 and 7.2.4.3.4: size in the initiation, segments of seven bytes with a toggle bit.
TEST_F(ObjectAccessTest, WritesAnImageBySegments) {
  constexpr canopen::ObjectAddress kImage{0x2400, 4};
  access.request(
      {.number = 1, .node_id = kController, .address = kImage, .data = {1, 2, 3, 4, 5, 6, 7, 8, 9}});
  access.process(0);
  ASSERT_EQ(sent.frames.size(), 1U);
  EXPECT_EQ(sent.frames[0].data, (sdo::Data{0x21, 0x00, 0x24, 0x04, 9, 0, 0, 0}));
  access.on_frame(answer(0x581, sdo::message(sdo::kInitiateDownloadResponse, kImage, 0)), 1);
  ASSERT_EQ(sent.frames.size(), 2U);
  EXPECT_EQ(sent.frames[1].data, (sdo::Data{0x00, 1, 2, 3, 4, 5, 6, 7}));
  access.on_frame(answer(0x581, {0x20}), 2);
  ASSERT_EQ(sent.frames.size(), 3U);
  EXPECT_EQ(sent.frames[2].data, (sdo::Data{0x10 | (5 << 1) | 1, 8, 9, 0, 0, 0, 0, 0}));
  EXPECT_TRUE(access.busy());
  access.on_frame(answer(0x581, {0x30}), 3);
  EXPECT_EQ(access.take_answers().at(0).abort, AbortCode::kNone);
  // A toggle bit that has not alternated ends the transfer.
  access.request({.number = 2, .node_id = kController, .address = kImage, .data = {1, 2, 3, 4, 5}});
  access.process(4);
  access.on_frame(answer(0x581, sdo::message(sdo::kInitiateDownloadResponse, kImage, 0)), 5);
  access.on_frame(answer(0x581, {0x30}), 6);
  EXPECT_EQ(access.take_answers().at(0).abort, AbortCode::kToggleBitNotAlternated);
}

TEST_F(ObjectAccessTest, EndsWithTheNodesAbort) {
  access.request({.number = 1, .node_id = kController, .address = kObject});
  access.process(0);
  access.on_frame(answer(0x581, sdo::message(sdo::kAbort, kObject,
                                             static_cast<std::uint32_t>(AbortCode::kObjectDoesNotExist))),
                  1);
  EXPECT_EQ(access.take_answers().at(0).abort, AbortCode::kObjectDoesNotExist);
}

TEST_F(ObjectAccessTest, AbortsAfterTheTimeOutAndGoesOn) {
  access.request({.number = 1, .node_id = kController, .address = kObject});
  access.request({.number = 2, .node_id = kDrive, .address = kObject});
  access.process(0);
  access.process(ObjectAccess::kTimeout_us - 1);
  EXPECT_EQ(sent.frames.size(), 1U);
  access.process(ObjectAccess::kTimeout_us);
  ASSERT_EQ(sent.frames.size(), 3U);
  EXPECT_EQ(sent.frames[1].data[0], sdo::kAbort);
  EXPECT_EQ(sent.frames[2].identifier, 0x680 + kDrive);
  EXPECT_EQ(access.take_answers().at(0).abort, AbortCode::kTimedOut);
}

TEST_F(ObjectAccessTest, RefusesAnAnswerThatBreaksTheProtocol) {
  access.request({.number = 1, .node_id = kController, .address = kObject});
  access.process(0);
  access.on_frame(answer(0x581, sdo::message(sdo::kInitiateDownloadResponse, kObject, 0)), 1);  // of a write
  EXPECT_NE(access.take_answers().at(0).abort, AbortCode::kNone);
  EXPECT_EQ(sent.frames.back().data[0], sdo::kAbort);
}

// Another client may use the channel, too: a master that reads the controller's faults.
TEST_F(ObjectAccessTest, SkipsAnswersAboutOtherObjects) {
  constexpr canopen::ObjectAddress kOther{0x2102, 3};
  access.request({.number = 1, .node_id = kController, .address = kObject});
  access.process(0);
  for (const sdo::Data& data :
       {sdo::message(sdo::expedited(sdo::kInitiateUploadResponse, 1), kOther, 0),
        sdo::message(sdo::kAbort, kOther, static_cast<std::uint32_t>(AbortCode::kObjectDoesNotExist)),
        sdo::Data{0x20}})
    EXPECT_FALSE(access.on_frame(answer(0x581, data), 1));
  EXPECT_TRUE(access.busy());
  EXPECT_TRUE(access.on_frame(
      answer(0x581, sdo::message(sdo::expedited(sdo::kInitiateUploadResponse, 1), kObject, 7)), 2));
  const auto answers = access.take_answers();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].abort, AbortCode::kNone);
  EXPECT_EQ(answers[0].data, std::vector<std::uint8_t>{7});
}

TEST_F(ObjectAccessTest, EndsAnUploadThatNeverEnds) {
  access.request({.number = 1, .node_id = kController, .address = kObject});
  access.process(0);
  access.on_frame(answer(0x581, sdo::message(sdo::kInitiateUploadResponse, kObject, 0)), 1);
  std::uint8_t toggle = 0;
  std::size_t segments = 0;
  while (access.busy() && segments < 10'000) {
    access.on_frame(answer(0x581, {toggle, 1, 2, 3, 4, 5, 6, 7}), 2);
    toggle ^= sdo::kToggle;
    ++segments;
  }
  EXPECT_EQ(segments, ObjectAccess::kMaxBytes / 7 + 1);
  EXPECT_EQ(access.take_answers().at(0).abort, AbortCode::kOutOfMemory);
}

}  // namespace
}  // namespace koboshi::simulation
