#include "view/live/batch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/unit/view/live/batch_reader.h"

namespace koboshi::view {
namespace {

Pose pose_at(float x) { return {{x, 2.0F, 3.0F}, Eigen::Quaternionf(0.5F, -0.5F, 0.5F, 0.5F)}; }

TEST(Batch, HoldsEveryNumberOfASample) {
  BatchMaker maker(2, 3);
  EXPECT_TRUE(maker.empty());
  const std::vector<Pose> links{pose_at(1.0F), pose_at(-1.0F)};
  const std::vector<ContactForce> contacts{{1, -1, {0.1F, 0.2F, 0.3F}, {4.0F, 5.0F, 6.0F}}};
  const std::vector<float> values{1.5F, std::numeric_limits<float>::quiet_NaN(), -2.5F};
  maker.add_sample(10'000, links, {}, values);
  maker.add_sample(20'000, links, contacts, values);
  EXPECT_FALSE(maker.empty());
  const Batch batch = maker.take();
  EXPECT_TRUE(maker.empty());
  EXPECT_EQ(batch.samples, 2u);
  EXPECT_TRUE(batch.marks.empty());
  const auto read = read_batches(batch.bytes);
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].times_us, (std::vector<double>{10'000, 20'000}));
  ASSERT_EQ(read[0].poses.size(), 28u);
  EXPECT_EQ(std::vector<float>(read[0].poses.begin() + 7, read[0].poses.begin() + 14),
            (std::vector<float>{-1.0F, 2.0F, 3.0F, -0.5F, 0.5F, 0.5F, 0.5F}));
  ASSERT_EQ(read[0].values.size(), 6u);
  EXPECT_EQ(read[0].values[3], 1.5F);
  EXPECT_TRUE(std::isnan(read[0].values[4]));
  EXPECT_EQ(read[0].counts, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(read[0].contacts, (std::vector<float>{1, -1, 0.1F, 0.2F, 0.3F, 4, 5, 6}));
  EXPECT_TRUE(read[0].json.is_null());
}

TEST(Batch, HoldsFramesWithKindNodeAndText) {
  BatchMaker maker(1, 0);
  maker.add_frame({1'234'567, {.identifier = 0x190, .size = 3, .data = {1, 2, 3}}});
  maker.add_frame({1'234'999, {.identifier = 0x710, .size = 1, .data = {5}}});
  const Batch batch = maker.take();
  EXPECT_EQ(batch.frames, 2u);
  const auto read = read_batches(batch.bytes);
  ASSERT_EQ(read.size(), 1u);
  const std::string& bytes = read[0].frames;
  ASSERT_EQ(bytes.size(), 48u);
  double end_us = 0.0;
  std::memcpy(&end_us, bytes.data() + 24, sizeof end_us);
  EXPECT_EQ(end_us, 1'234'999.0);
  // Identifier, size, remote, kind, node, text, data.
  EXPECT_EQ(bytes.substr(8, 11), std::string("\x90\x01\x03\x00\x04\x10\xFF\xFF\x01\x02\x03", 11));
  EXPECT_EQ(bytes.substr(32, 9), std::string("\x10\x07\x01\x00\x06\x10\x00\x00\x05", 9));
  EXPECT_EQ(read[0].json["texts"][0], "heartbeat node 16: operational");
}

// The block begins in one batch and goes on in the next; its segment looks like a read.
TEST(Batch, KnowsSegmentsOfBlockTransfersThatBeganEarlier) {
  BatchMaker maker(1, 0);
  maker.add_frame({1, {.identifier = 0x610, .size = 8, .data = {0xC6, 0x00, 0x21, 1, 40}}});
  maker.add_frame({2, {.identifier = 0x590, .size = 8, .data = {0xA4, 0x00, 0x21, 1, 127}}});
  static_cast<void>(maker.take());
  maker.add_frame({3, {.identifier = 0x610, .size = 8, .data = {0x40, 0x18, 0x10, 1}}});
  EXPECT_EQ(read_batches(maker.take().bytes)[0].json["texts"][0], "SDO node 16: block segment 64");
}

TEST(Batch, HoldsEventsAndPushesAlsoByThemselves) {
  BatchMaker maker(1, 1);
  maker.add_sample(10'000, std::vector{pose_at(0.0F)}, {}, std::vector{1.0F});
  maker.add_event({5'000, "state", "Stands \"up\"."});
  maker.add_push({1'000, 2'000, 0, Eigen::Vector3d::Zero(), {1.0, 0.0, 0.0}});
  const Batch batch = maker.take();
  const auto whole = read_batches(batch.bytes);
  const auto marks = read_batches(batch.marks);
  ASSERT_EQ(whole.size(), 1u);
  ASSERT_EQ(marks.size(), 1u);
  EXPECT_EQ(whole[0].json["events"], marks[0].json["events"]);
  EXPECT_EQ(marks[0].json["events"][0]["text"], "Stands \"up\".");
  EXPECT_EQ(marks[0].json["pushes"][0]["force"][0], 1.0);
  EXPECT_TRUE(marks[0].times_us.empty());
}

}  // namespace
}  // namespace koboshi::view
