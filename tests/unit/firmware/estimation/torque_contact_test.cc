// Contact from torques, at both sides of each limit. The efforts are exact after one cycle: a torque of n
// permille from rest makes an effort of n / 8.

#include "firmware/estimation/torque_contact.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::estimation {
namespace {

using hal::Side;
using Contacts = hal::BySide<bool>;

constexpr Contacts kBothFeet{true, true};
constexpr Contacts kLeftOnly{true, false};
constexpr Contacts kRightOnly{false, true};
constexpr int kSettled = 100;  // cycles after which an effort changes no more

class TorqueContactTest : public testing::Test {
 protected:
  // Takes cycles in which the efforts of the legs approach these sums, in several joints and signs.
  Contacts update(int left_permille, int right_permille, int cycles = 1) {
    set(Side::kLeft, left_permille);
    set(Side::kRight, right_permille);
    for (int i = 0; i < cycles; ++i) contacts_ = contact_.update(evidence_);
    return contacts_;
  }

  robot::RobotModel model_ = test::make_test_robot();
  std::array<std::int16_t, robot::kMaxJoints> torques_{};
  LegEvidence evidence_{.torques_permille = torques_};
  TorqueContact contact_{model_};

 private:
  void set(Side side, int sum_permille) {
    const auto leg = model_.leg(side);
    for (std::size_t i = 0; i < leg.size(); ++i) {
      const int part = sum_permille / 6 + (i == 0 ? sum_permille % 6 : 0);
      torques_[leg[i]] = static_cast<std::int16_t>(i % 2 == 0 ? part : -part);
    }
  }

  Contacts contacts_{};
};

TEST_F(TorqueContactTest, SumsTheMagnitudesOfEveryJointOfALeg) {
  for (const Side side : {Side::kLeft, Side::kRight}) {
    for (const robot::JointIndex joint : model_.leg(side)) {
      for (const std::int16_t torque : {std::int16_t{3'000}, std::int16_t{-3'000}}) {
        torques_.fill(0);
        torques_[joint] = torque;
        EXPECT_EQ(TorqueContact(model_).update(evidence_), side == Side::kLeft ? kLeftOnly : kRightOnly)
            << static_cast<int>(joint);
      }
    }
  }
}

TEST_F(TorqueContactTest, IgnoresArmsAndHead) {
  for (std::size_t joint = 12; joint < model_.joint_count; ++joint) torques_[joint] = 3'000;
  EXPECT_EQ(contact_.update(evidence_), kBothFeet);
}

// Both efforts together: 200 permille tell, less does not.
TEST_F(TorqueContactTest, NeedsAnEffortThatTells) {
  EXPECT_EQ(update(1'600, 0), kLeftOnly) << "exactly 200";
  TorqueContact other(model_);
  contact_ = other;
  EXPECT_EQ(update(1'599, 0), kBothFeet);
  contact_ = other;
  EXPECT_EQ(update(200, 0, kSettled), kBothFeet) << "the effort approaches 200 from below";
  EXPECT_EQ(update(201, 0, kSettled), kLeftOnly);
  EXPECT_EQ(update(0, 0, kSettled), kBothFeet) << "a robot that goes limp";
}

TEST_F(TorqueContactTest, LosesAFootBelowAShareOfAQuarter) {
  EXPECT_EQ(update(3'000, 1'000), kBothFeet) << "exactly a quarter";
  EXPECT_EQ(update(1'499, 501, kSettled), kBothFeet);
  EXPECT_EQ(update(1'501, 499, kSettled), kLeftOnly);
  const TorqueContact other(model_);
  contact_ = other;
  EXPECT_EQ(update(1'000, 3'000), kBothFeet);
  EXPECT_EQ(update(501, 1'499, kSettled), kBothFeet);
  EXPECT_EQ(update(499, 1'501, kSettled), kRightOnly);
}

TEST_F(TorqueContactTest, RegainsAFootAtAShareOf35Percent) {
  update(1'600, 0);
  // From 200 and 0: 200 * 7 / 8 + 1200 / 8 = 325 and 175.
  EXPECT_EQ(update(1'200, 1'400), kBothFeet) << "exactly 35 percent";
  update(2'000, 0, kSettled);
  EXPECT_EQ(update(1'301, 699, kSettled), kLeftOnly);
  EXPECT_EQ(update(1'299, 701, kSettled), kBothFeet);
  update(0, 2'000, kSettled);
  EXPECT_EQ(update(699, 1'301, kSettled), kRightOnly);
  EXPECT_EQ(update(701, 1'299, kSettled), kBothFeet);
}

// The effort of a leg that is lifted falls as (7 / 8)^n. Its share is a quarter at 1/3: n = 8.23.
TEST_F(TorqueContactTest, SmoothsOverEightCycles) {
  update(1'000, 1'000, kSettled);
  EXPECT_EQ(update(1'000, 0, 8), kBothFeet);
  EXPECT_EQ(update(1'000, 0), kLeftOnly);
}

TEST_F(TorqueContactTest, FollowsThePlanInAWalkAndTheTorquesAfterIt) {
  evidence_.walks = true;
  evidence_.swing = Side::kLeft;
  EXPECT_EQ(update(3'000, 0), kRightOnly);
  evidence_.swing = Side::kRight;
  EXPECT_EQ(update(0, 3'000), kLeftOnly);
  evidence_.swing.reset();
  EXPECT_EQ(update(3'000, 0, kSettled), kBothFeet);
  // The efforts were followed meanwhile.
  evidence_.walks = false;
  EXPECT_EQ(update(3'000, 0), kLeftOnly);
  // A planned swing counts in a walk only.
  evidence_.swing = Side::kLeft;
  EXPECT_EQ(update(3'000, 0), kLeftOnly);
}

TEST_F(TorqueContactTest, TakesMissingTorquesForZero) {
  evidence_.torques_permille = {};
  EXPECT_EQ(contact_.update(evidence_), kBothFeet);
}

}  // namespace
}  // namespace koboshi::estimation
