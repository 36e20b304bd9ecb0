#include "studio/run/controller_inquiry.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace koboshi::studio {
namespace {

using canopen::AbortCode;
using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(std::uint32_t value, std::size_t size) {
  Bytes bytes;
  for (std::size_t i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  return bytes;
}

Bytes text(const std::string& name) { return {name.begin(), name.end()}; }

// A controller with two motions, of which the second has a number beyond the first mask.
struct Robot {
  std::map<std::pair<int, int>, Bytes> objects{
      {{0x2111, 1}, bytes_of(200, 2)}, {{0x2111, 2}, bytes_of(100, 2)}, {{0x2111, 3}, bytes_of(50, 2)},
      {{0x2111, 4}, bytes_of(700, 2)}, {{0x2403, 1}, bytes_of(1, 4)},   {{0x2403, 2}, bytes_of(2, 4)},
      {{0x2401, 1}, text("stand")},    {{0x2401, 34}, text("bow")}};

  simulation::ObjectAnswer answer(const simulation::ObjectRequest& request) const {
    EXPECT_EQ(request.node_id, 1);
    EXPECT_TRUE(request.data.empty());
    const auto found = objects.find({request.address.index, request.address.subindex});
    if (found == objects.end()) return {.number = request.number, .abort = AbortCode::kSubindexDoesNotExist};
    return {.number = request.number, .data = found->second};
  }
};

simulation::ObjectAnswer failure(const simulation::ObjectRequest& request, AbortCode abort) {
  return {.number = request.number, .abort = abort};
}

void answer_all(ControllerInquiry& inquiry, const Robot& robot, std::uint64_t now_us) {
  for (auto requests = inquiry.due(now_us); !requests.empty(); requests = inquiry.due(now_us))
    for (const simulation::ObjectRequest& request : requests)
      EXPECT_TRUE(inquiry.take(robot.answer(request), now_us));
}

void expect_all(const ControllerInquiry& inquiry) {
  EXPECT_TRUE(inquiry.complete());
  EXPECT_EQ(inquiry.limits(), (walk::VelocityLimits{200, 100, 50, 700}));
  EXPECT_EQ(inquiry.motions(),
            (std::vector<std::pair<std::uint16_t, std::string>>{{0, "stand"}, {33, "bow"}}));
}

TEST(ControllerInquiry, LearnsLimitsAndMotions) {
  ControllerInquiry inquiry;
  EXPECT_FALSE(inquiry.complete());
  EXPECT_TRUE(inquiry.motions().empty());
  answer_all(inquiry, Robot(), 0);
  expect_all(inquiry);
  EXPECT_TRUE(inquiry.due(10'000'000).empty());
}

TEST(ControllerInquiry, AsksAgainUntilItIsAnswered) {
  for (const AbortCode lost : {AbortCode::kTimedOut, AbortCode::kGeneralError}) {
    ControllerInquiry inquiry;
    std::uint64_t now_us = 0;
    for (int attempt = 0; attempt < 5; ++attempt) {
      const auto requests = inquiry.due(now_us);
      EXPECT_EQ(requests.size(), 11U);
      EXPECT_TRUE(inquiry.due(now_us).empty());  // under way
      for (const simulation::ObjectRequest& request : requests)
        EXPECT_TRUE(inquiry.take(failure(request, lost), now_us));
      EXPECT_TRUE(inquiry.due(now_us + ControllerInquiry::kRetry_us - 1).empty());
      now_us += ControllerInquiry::kRetry_us;
    }
    EXPECT_FALSE(inquiry.complete());
    answer_all(inquiry, Robot(), now_us);
    expect_all(inquiry);
  }
}

// A name that is lost is asked for again, and no other.
TEST(ControllerInquiry, RepeatsOnlyWhatIsMissing) {
  ControllerInquiry inquiry;
  const Robot robot;
  for (const simulation::ObjectRequest& request : inquiry.due(0))
    EXPECT_TRUE(inquiry.take(robot.answer(request), 0));
  const auto names = inquiry.due(0);
  ASSERT_EQ(names.size(), 2U);
  EXPECT_TRUE(inquiry.take(failure(names[0], AbortCode::kTimedOut), 0));
  EXPECT_TRUE(inquiry.take(robot.answer(names[1]), 0));
  EXPECT_FALSE(inquiry.complete());
  const auto again = inquiry.due(ControllerInquiry::kRetry_us);
  ASSERT_EQ(again.size(), 1U);
  EXPECT_EQ(again[0].address, names[0].address);
  EXPECT_TRUE(inquiry.take(robot.answer(again[0]), ControllerInquiry::kRetry_us));
  expect_all(inquiry);
}

TEST(ControllerInquiry, AcceptsAControllerWithoutTheObjects) {
  ControllerInquiry inquiry;
  Robot robot;
  robot.objects.clear();
  answer_all(inquiry, robot, 0);
  EXPECT_TRUE(inquiry.complete());
  EXPECT_EQ(inquiry.limits(), walk::VelocityLimits());
  EXPECT_TRUE(inquiry.motions().empty());
}

TEST(ControllerInquiry, LeavesAnswersToOthersAlone) {
  ControllerInquiry inquiry;
  static_cast<void>(inquiry.due(0));
  for (const std::uint64_t number : {std::uint64_t{1}, std::uint64_t{1} << 40, std::uint64_t{4} << 40,
                                     ControllerInquiry::kFirstNumber + 11})
    EXPECT_FALSE(inquiry.take({.number = number, .data = {1, 0}}, 0));
  EXPECT_FALSE(inquiry.complete());
}

}  // namespace
}  // namespace koboshi::studio
