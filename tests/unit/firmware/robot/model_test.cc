#include "firmware/robot/model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::robot {
namespace {

ModelStatus load_changed(const std::function<void(RobotModel&)>& change) {
  RobotModel model = test::make_test_robot();
  change(model);
  RobotModel loaded;
  return load_model(test::encode(model), loaded);
}

TEST(RobotModel, RoundTrips) {
  const RobotModel written = test::make_test_robot();
  const std::vector<std::byte> image = test::encode(written);
  RobotModel read;
  ASSERT_EQ(load_model(image, read), ModelStatus::kOk);
  EXPECT_EQ(read.joint_count, 20u);
  EXPECT_EQ(test::encode(read), image);
}

TEST(RobotModel, RoundTripsWithOtherSensors) {
  RobotModel written = test::make_test_robot();
  written.ankle_kind = hal::AnkleKind::kPressureCells;
  written.imu_link = LinkIndex(JointIndex(19));
  int number = 1;
  for (Foot& foot : written.feet) {
    for (Cell& cell : foot.cells) {
      cell.x = fixed::Length::from_raw(number++);
      cell.y = fixed::Length::from_raw(-number++);
    }
  }
  const std::vector<std::byte> image = test::encode(written);
  ASSERT_EQ(image.size(), test::encode(test::make_test_robot()).size() + 66);
  RobotModel read;
  ASSERT_EQ(load_model(image, read), ModelStatus::kOk);
  EXPECT_EQ(read.ankle_kind, hal::AnkleKind::kPressureCells);
  EXPECT_EQ(read.imu_link, written.imu_link);
  EXPECT_EQ(read.feet[1].cells[3].y.raw(), -16);
  EXPECT_EQ(test::encode(read), image);
}

TEST(RobotModel, RoundTripsWithAFollower) {
  RobotModel written = test::with_shared_yaw(test::make_test_robot(), -0.5);
  written.couplings[0].offset = test::degrees(3.0);
  const std::vector<std::byte> image = test::encode(written);
  RobotModel read;
  ASSERT_EQ(load_model(image, read), ModelStatus::kOk);
  EXPECT_EQ(test::encode(read), image);
  EXPECT_EQ(read.joint_count, 19U);
  EXPECT_EQ(read.hinge_count(), 20U);
  EXPECT_FALSE(read.find(JointRole::kRightHipYaw).has_value());
  const auto yaw = read.find_hinge(JointRole::kRightHipYaw);
  ASSERT_TRUE(yaw && read.is_follower(*yaw));
  EXPECT_TRUE(read.leads(*read.find(JointRole::kLeftHipYaw)));
  std::array<fixed::Angle, kMaxJoints> angles{};
  angles[*read.find(JointRole::kLeftHipYaw)] = test::degrees(20.0);
  EXPECT_NEAR(fixed::to_double(read.hinge_angle(angles, *yaw)), -7.0 * test::kRadPerDegree, 1e-6);

  written.ankle_kind = hal::AnkleKind::kPressureCells;
  ASSERT_EQ(load_model(test::encode(written), read), ModelStatus::kOk);
  EXPECT_EQ(read.ankle_kind, hal::AnkleKind::kPressureCells);
  EXPECT_EQ(read.follower_count, 1U);
}

TEST(RobotModel, RejectsCouplingsOfNoMotor) {
  const auto status = [](const std::function<void(RobotModel&)>& change) {
    RobotModel model = test::with_shared_yaw(test::make_test_robot(), -1.0);
    change(model);
    RobotModel loaded;
    return load_model(test::encode(model), loaded);
  };
  const auto ratio = [](double value) { return fixed::from_double<fixed::Gain>(value); };
  EXPECT_EQ(status([](RobotModel&) {}), ModelStatus::kOk);
  EXPECT_EQ(status([](RobotModel& model) { model.couplings[0].leader = JointIndex(19); }),
            ModelStatus::kBadCoupling);  // itself
  EXPECT_EQ(status([&](RobotModel& model) { model.couplings[0].multiplier = ratio(0.04); }),
            ModelStatus::kBadCoupling);
  EXPECT_EQ(status([&](RobotModel& model) { model.couplings[0].multiplier = ratio(-8.1); }),
            ModelStatus::kBadCoupling);
  // 90 degrees, three times.
  EXPECT_EQ(status([&](RobotModel& model) { model.couplings[0].multiplier = ratio(3.0); }),
            ModelStatus::kBadCoupling);
  EXPECT_EQ(status([](RobotModel& model) {
              model.follower_count = 2;
              model.joints[20] = model.joints[19];
              model.joints[20].role = JointRole::kOther;
              model.couplings[1] = model.couplings[0];
            }),
            ModelStatus::kBadCoupling);  // a second one of the joint
  EXPECT_EQ(status([](RobotModel& model) { model.joints[19].role = JointRole::kLeftHipYaw; }),
            ModelStatus::kDuplicateRole);
}

// An image of before, without the last part.
TEST(RobotModel, HasItsUnitInTheTrunkAndSixAxesUnlessItSaysOtherwise) {
  RobotModel read;
  read.ankle_kind = hal::AnkleKind::kNone;
  read.imu_link = LinkIndex(JointIndex(19));
  ASSERT_EQ(load_model(test::encode(test::make_test_robot()), read), ModelStatus::kOk);
  EXPECT_EQ(read.ankle_kind, hal::AnkleKind::kSixAxis);
  EXPECT_TRUE(read.imu_link.is_trunk());
}

TEST(RobotModel, HasAnIdDerivedFromItsContent) {
  RobotModel first;
  RobotModel second;
  RobotModel other = test::make_test_robot();
  other.joints[19].mass += fixed::Mass::from_raw(1);
  RobotModel heavier;
  ASSERT_EQ(load_model(test::encode(test::make_test_robot()), first), ModelStatus::kOk);
  ASSERT_EQ(load_model(test::encode(test::make_test_robot()), second), ModelStatus::kOk);
  ASSERT_EQ(load_model(test::encode(other), heavier), ModelStatus::kOk);
  EXPECT_EQ(first.id, second.id);
  EXPECT_NE(first.id, heavier.id);
}

TEST(RobotModel, RejectsEveryTruncatedImage) {
  const std::vector<std::byte> image = test::encode(test::make_test_robot());
  RobotModel model;
  for (std::size_t size = 0; size < image.size(); ++size) {
    EXPECT_EQ(load_model(std::span(image).first(size), model), ModelStatus::kTruncated) << size;
  }
}

TEST(RobotModel, RejectsABodyOfWrongSize) {
  std::vector<std::byte> image = test::encode(test::make_test_robot());
  RobotModel model;
  image.push_back(std::byte{0});
  test::seal(image);
  EXPECT_EQ(load_model(image, model), ModelStatus::kBadSize);
  image.pop_back();
  image.pop_back();
  test::seal(image);
  EXPECT_EQ(load_model(image, model), ModelStatus::kBadSize);
}

TEST(RobotModel, RefusesWithTheReason) {
  using Model = RobotModel;
  using enum ModelStatus;
  EXPECT_EQ(load_changed([](Model& m) { m.joint_count = 0; }), kBadJointCount);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].drive.sign = 2; }), kBadField);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].mirror_sign = 0; }), kBadField);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].drive.node_id = 128; }), kBadField);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].drive.position_bits = 32; }), kBadField);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].mirror = JointIndex(20); }), kBadField);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].parent = LinkIndex::from_raw(20); }), kBadField);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].parent = LinkIndex::from_raw(-2); }), kBadField);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].role = static_cast<JointRole>(kRoleCount); }), kBadField);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].max_speed = {}; }), kOutOfRange);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].mass = fixed::Mass::from_raw(-1); }), kOutOfRange);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].anchor.x = fixed::Length::max(); }), kOutOfRange);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].anchor.x = fixed::Length::min(); }), kOutOfRange);
  EXPECT_EQ(load_changed([](Model& m) { m.base_mass = {}; }), kOutOfRange);
  EXPECT_EQ(load_changed([](Model& m) { m.feet[1].back = m.feet[1].front; }), kOutOfRange);
  EXPECT_EQ(load_changed([](Model& m) { m.scales.gyro = {}; }), kOutOfRange);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[14].axis.x = fixed::Ratio::from_raw(1 << 22); }),
            kNotARotation);
  EXPECT_EQ(load_changed([](Model& m) { m.R_BI.rows[2] = -m.R_BI.rows[2]; }), kNotARotation);
  EXPECT_EQ(load_changed([](Model& m) { m.R_BI.rows[2] = m.R_BI.rows[1]; }), kNotARotation);
  EXPECT_EQ(load_changed([](Model& m) { std::swap(m.joints[3].lower, m.joints[3].upper); }), kLimitsReversed);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[12].parent = LinkIndex::from_raw(14); }), kCyclicTree);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[12].parent = LinkIndex::from_raw(12); }), kCyclicTree);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].drive.node_id = 16; }), kDuplicateNodeId);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[14].role = JointRole::kHeadPan; }), kDuplicateRole);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].mirror = JointIndex(3); }), kBadMirror);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].mirror_sign = -1; }), kBadMirror);
  // A leg that lacks a joint only cannot walk; a side without any joint of a leg has no foot.
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].role = JointRole::kOther; }), kOk);
  EXPECT_EQ(load_changed([](Model& m) {
              for (Joint& joint : m.joints)
                if (joint.role >= JointRole::kLeftHipYaw && joint.role <= JointRole::kLeftAnkleRoll)
                  joint.role = JointRole::kOther;
            }),
            kBadLeg);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[3].axis = kAxisX; }), kBadLeg);
  EXPECT_EQ(load_changed([](Model& m) { m.joints[2].parent = LinkIndex(JointIndex(0)); }), kBadLeg);
}

TEST(RobotModel, SortsJointsListedBeforeTheirParents) {
  RobotModel model = test::make_test_robot();
  std::swap(model.joints[18], model.joints[19]);  // makes pan the parent of tilt
  for (const std::size_t i : {18u, 19u}) model.joints[i].mirror = JointIndex(i);
  model.joints[18].parent = LinkIndex::from_raw(19);
  RobotModel loaded;
  ASSERT_EQ(load_model(test::encode(model), loaded), ModelStatus::kOk);
  const auto place = [&](std::size_t joint) {
    return std::find(loaded.order.begin(), loaded.order.begin() + 20, joint) - loaded.order.begin();
  };
  EXPECT_LT(place(19), place(18));
}

// For any bytes, loading returns a status, reads nothing outside the image (checked by the address
// sanitizer), and accepts only a consistent model.
TEST(RobotModel, SurvivesMutatedImages) {
  const std::uint32_t seed = 20260101;
  RecordProperty("seed", static_cast<int>(seed));
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const std::vector<std::byte> good = test::encode(test::make_test_robot());
  int accepted = 0;
  for (int round = 0; round < 20000; ++round) {
    std::vector<std::byte> image = good;
    for (auto count = 1 + random() % 3; count > 0; --count) {
      image[16 + random() % (image.size() - 16)] = static_cast<std::byte>(random());
    }
    test::seal(image);
    RobotModel model;
    if (load_model(image, model) != ModelStatus::kOk) continue;
    ++accepted;
    for (std::size_t i = 0; i < model.joint_count; ++i) {
      ASSERT_LE(model.joints[i].lower, model.joints[i].upper);
      ASSERT_LT(model.joints[i].mirror, model.joint_count);
      ASSERT_LT(model.order[i], model.joint_count);
    }
  }
  EXPECT_GT(accepted, 1000);
  EXPECT_LT(accepted, 19000);
}

TEST(DriveUnits, ConvertBetweenShaftAndJoint) {
  const Drive drive{.node_id = 16, .sign = -1, .position_bits = 20, .zero = test::degrees(90)};
  EXPECT_EQ(drive_position(drive, fixed::Angle()), 1 << 18);
  EXPECT_EQ(drive_position(drive, test::degrees(45)), 1 << 17);
  EXPECT_EQ(joint_angle(drive, 1 << 17), test::degrees(45));
  // A target of -170 degrees puts this shaft at 260, which must not wrap to -100.
  EXPECT_NEAR(drive_position(drive, test::degrees(-170)), 260.0 / 360.0 * (1 << 20), 1.0);
  EXPECT_NEAR(fixed::to_double(joint_angle(drive, drive_position(drive, test::degrees(-170)))),
              -170 * test::kRadPerDegree, 1e-5);
}

TEST(DriveUnits, RoundTheShaftToTheNearestUnitAtEveryResolution) {
  for (int bits = 8; bits <= 31; ++bits) {
    for (const double zero_deg : {-179.0, 0.0, 0.001, 179.0}) {
      for (const double angle_deg : {-180.0, -90.0, -0.0001, 0.0, 33.3, 179.9}) {
        const Drive drive{
            .sign = -1, .position_bits = static_cast<std::uint8_t>(bits), .zero = test::degrees(zero_deg)};
        const fixed::Angle angle = test::degrees(angle_deg);
        const double shaft_turns = (static_cast<double>(drive.zero.raw()) - angle.raw()) * 0x1p-32;
        const double units = std::clamp(std::round(std::ldexp(shaft_turns, bits)), -0x1p31, 0x1p31 - 1.0);
        EXPECT_EQ(drive_position(drive, angle), units) << bits << " bits, " << zero_deg << ", " << angle_deg;
      }
    }
  }
}

TEST(DriveUnits, SaturateJustPastAStopAtHalfATurn) {
  const Drive drive{.node_id = 16, .sign = 1, .position_bits = 20, .zero = {}};
  EXPECT_EQ(joint_angle(drive, (1 << 19) + 5), fixed::Angle::max());
  EXPECT_EQ(joint_angle(drive, -(1 << 19) - 5), fixed::Angle::min());
}

}  // namespace
}  // namespace koboshi::robot
