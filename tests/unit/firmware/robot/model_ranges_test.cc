// The model's check accepts the ends of each range (docs/reference/robot-model-format.md) and nothing beyond.

#include <gtest/gtest.h>

#include <functional>
#include <initializer_list>
#include <utility>

#include "firmware/robot/model.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::robot {
namespace {

using enum ModelStatus;
using Model = RobotModel;

ModelStatus status(const std::function<void(Model&)>& change) {
  Model model = test::make_test_robot();
  change(model);
  Model loaded;
  return load_model(test::encode(model), loaded);
}

// Raw values of an integer field.
template <typename T>
void expect_range(const std::function<T&(Model&)>& field, std::initializer_list<int> good,
                  std::initializer_list<int> bad, ModelStatus otherwise) {
  for (const int value : good)
    EXPECT_EQ(status([&](Model& m) { field(m) = static_cast<T>(value); }), kOk) << value;
  for (const int value : bad)
    EXPECT_EQ(status([&](Model& m) { field(m) = static_cast<T>(value); }), otherwise) << value;
}

// Lengths of up to kMaxOffset, to both sides.
void expect_offset(const std::function<fixed::Length&(Model&)>& field) {
  for (const int sign : {-1, 1}) {
    const std::int32_t most = sign * kMaxOffset.raw();
    EXPECT_EQ(status([&](Model& m) { field(m) = fixed::Length::from_raw(most); }), kOk) << sign;
    EXPECT_EQ(status([&](Model& m) { field(m) = fixed::Length::from_raw(most + sign); }), kOutOfRange)
        << sign;
  }
}
void expect_offsets(const std::function<Position&(Model&)>& field) {
  expect_offset([&](Model& m) -> fixed::Length& { return field(m).x; });
  expect_offset([&](Model& m) -> fixed::Length& { return field(m).y; });
  expect_offset([&](Model& m) -> fixed::Length& { return field(m).z; });
}

// 0 is in no drive's node id, and 127 the last one of CiA 301.
TEST(ModelRanges, OfDrives) {
  expect_range<std::uint8_t>(
      [](Model & m) -> auto& { return m.joints[18].drive.node_id; }, {1, 127}, {0, 128, 255}, kBadField);
  expect_range<std::uint8_t>(
      [](Model & m) -> auto& { return m.joints[18].drive.position_bits; }, {8, 31}, {0, 7, 32, 255},
      kBadField);
  expect_range<std::int8_t>(
      [](Model & m) -> auto& { return m.joints[18].drive.sign; }, {-1, 1}, {-2, 0, 2}, kBadField);
  expect_range<std::int8_t>(
      [](Model & m) -> auto& { return m.joints[18].mirror_sign; }, {-1, 1}, {-2, 0, 2}, kBadField);
}

TEST(ModelRanges, OfJoints) {
  expect_offsets([](Model & m) -> auto& { return m.joints[18].anchor; });
  expect_offsets([](Model & m) -> auto& { return m.joints[18].centre_of_mass; });
  const auto with_mass = [](std::int32_t raw) {
    return status([raw](Model& m) { m.joints[18].mass = fixed::Mass::from_raw(raw); });
  };
  EXPECT_EQ(with_mass(0), kOk);
  EXPECT_EQ(with_mass(kMaxLinkMass.raw()), kOk);
  EXPECT_EQ(with_mass(kMaxLinkMass.raw() + 1), kOutOfRange);
  EXPECT_EQ(status([](Model& m) { m.joints[18].max_speed = fixed::AngularRate::from_raw(1); }), kOk);
  EXPECT_EQ(status([](Model& m) { m.joints[18].max_speed = fixed::AngularRate::from_raw(-1); }), kOutOfRange);
  EXPECT_EQ(status([](Model& m) { m.joints[18].lower = m.joints[18].upper; }), kOk);
  EXPECT_EQ(
      status([](Model& m) { m.joints[18].lower = fixed::Angle::from_raw(m.joints[18].upper.raw() + 1); }),
      kLimitsReversed);
}

TEST(ModelRanges, OfTheBody) {
  EXPECT_EQ(kMaxOffset.raw(), 1 << 24);      // 1 m
  EXPECT_EQ(kMaxLinkMass.raw(), 32 << 24);   // 32 kg
  EXPECT_EQ(kMaxRobotMass.raw(), 64 << 24);  // 64 kg
  expect_offsets([](Model & m) -> auto& { return m.base_centre_of_mass; });
  const auto with_mass = [](std::int32_t raw) {
    return status([raw](Model& m) { m.base_mass = fixed::Mass::from_raw(raw); });
  };
  EXPECT_EQ(with_mass(1), kOk);
  EXPECT_EQ(with_mass(kMaxLinkMass.raw()), kOk);
  EXPECT_EQ(with_mass(kMaxLinkMass.raw() + 1), kOutOfRange);
  const auto with_height = [](std::int32_t raw) {
    return status([raw](Model& m) { m.body_height = fixed::Length::from_raw(raw); });
  };
  EXPECT_EQ(with_height(0), kOutOfRange);
  EXPECT_EQ(with_height(1), kOk);
  EXPECT_EQ(with_height(2 * kMaxOffset.raw()), kOk);
  EXPECT_EQ(with_height(2 * kMaxOffset.raw() + 1), kOutOfRange);
}

TEST(ModelRanges, OfAllLinksTogether) {
  const auto with_sum = [](std::int32_t raw) {
    return status([raw](Model& m) {
      m.base_mass = kMaxLinkMass;
      for (std::size_t i = 0; i < m.joint_count; ++i) m.joints[i].mass = {};
      m.joints[3].mass = fixed::Mass::from_raw(kMaxRobotMass.raw() - kMaxLinkMass.raw() - 1);
      m.joints[18].mass = fixed::Mass::from_raw(raw);
    });
  };
  EXPECT_EQ(with_sum(1), kOk);
  EXPECT_EQ(with_sum(2), kOutOfRange);
  EXPECT_EQ(with_sum(kMaxLinkMass.raw()), kOutOfRange);
}

TEST(ModelRanges, OfEachFoot) {
  for (const std::size_t side : {0u, 1u}) {
    expect_offsets([side](Model & m) -> auto& { return m.feet[side].sensor; });
    const auto with = [side](fixed::Length Foot::*edge, std::int32_t raw) {
      return status([=](Model& m) { m.feet[side].*edge = fixed::Length::from_raw(raw); });
    };
    const std::int32_t most = kMaxOffset.raw();
    for (const auto edge : {&Foot::back, &Foot::right}) {
      EXPECT_EQ(with(edge, -most), kOk);
      EXPECT_EQ(with(edge, -most - 1), kOutOfRange);
    }
    for (const auto edge : {&Foot::front, &Foot::left}) {
      EXPECT_EQ(with(edge, most), kOk);
      EXPECT_EQ(with(edge, most + 1), kOutOfRange);
    }
    EXPECT_EQ(with(&Foot::ankle_height, 0), kOk);
    EXPECT_EQ(with(&Foot::ankle_height, -1), kOutOfRange);
    EXPECT_EQ(with(&Foot::ankle_height, most), kOk);
    EXPECT_EQ(with(&Foot::ankle_height, most + 1), kOutOfRange);
    EXPECT_EQ(status([side](Model& m) { m.feet[side].back = m.feet[side].front; }), kOutOfRange);
    EXPECT_EQ(status([side](Model& m) { m.feet[side].right = m.feet[side].left; }), kOutOfRange);
  }
}

TEST(ModelRanges, OfEachScale) {
  EXPECT_EQ(status([](Model& m) { m.scales.gyro = fixed::AngularRate::from_raw(-1); }), kOutOfRange);
  EXPECT_EQ(status([](Model& m) { m.scales.accelerometer = {}; }), kOutOfRange);
  EXPECT_EQ(status([](Model& m) { m.scales.ankle_force = {}; }), kOutOfRange);
  EXPECT_EQ(status([](Model& m) { m.scales.ankle_torque = {}; }), kOutOfRange);
  EXPECT_EQ(status([](Model& m) {
              m.scales.gyro = fixed::AngularRate::from_raw(1);
              m.scales.accelerometer = fixed::Acceleration::from_raw(1);
              m.scales.ankle_force = fixed::Force::from_raw(1);
              m.scales.ankle_torque = fixed::Torque::from_raw(1);
            }),
            kOk);
}

TEST(ModelRanges, OfTheSensors) {
  const auto with_kind = [](int kind) {
    return status([kind](Model& m) {
      m.ankle_kind = static_cast<hal::AnkleKind>(kind);
      m.imu_link = LinkIndex(JointIndex(0));
    });
  };
  for (const int kind : {0, 1, 2, 3}) EXPECT_EQ(with_kind(kind), kOk) << kind;
  for (const int kind : {4, 255}) EXPECT_EQ(with_kind(kind), kBadField) << kind;
  const auto with_unit_in = [](int link) {
    return status([link](Model& m) { m.imu_link = LinkIndex::from_raw(static_cast<std::int8_t>(link)); });
  };
  for (const int link : {-1, 0, 19}) EXPECT_EQ(with_unit_in(link), kOk) << link;
  for (const int link : {-128, -2, 20, 127}) EXPECT_EQ(with_unit_in(link), kBadField) << link;
  for (const std::size_t side : {0u, 1u}) {
    for (std::size_t cell = 0; cell < hal::kPressureCells; ++cell) {
      expect_offset([=](Model & m) -> auto& { return m.feet[side].cells[cell].x; });
      expect_offset([=](Model & m) -> auto& { return m.feet[side].cells[cell].y; });
    }
  }
}

// Sensors of the feet that measure no force have no scale.
TEST(ModelRanges, OfScalesBySensors) {
  for (const int kind : {0, 1, 2, 3}) {
    for (const bool force : {false, true}) {
      const ModelStatus expected = kind < 2 ? kOutOfRange : kOk;
      EXPECT_EQ(status([=](Model& m) {
                  m.ankle_kind = static_cast<hal::AnkleKind>(kind);
                  if (force) m.scales.ankle_force = {};
                  if (!force) m.scales.ankle_torque = {};
                }),
                expected)
          << kind << force;
    }
  }
}

// Numbers of the image, and those that a tool prints: other programs know no names.
TEST(ModelNumbers, AreThoseOfTheFormat) {
  int number = 0;
  for (const ModelStatus status :
       {kOk, kTruncated, kBadMagic, kBadVersion, kBadSize, kBadCrc, kBadJointCount, kBadField, kOutOfRange,
        kNotARotation, kLimitsReversed, kCyclicTree, kDuplicateNodeId, kDuplicateRole, kBadMirror, kBadLeg})
    EXPECT_EQ(static_cast<int>(status), number++);
  EXPECT_EQ(kMaxJoints, 31u);
  EXPECT_EQ(kModelNameSize, 24u);
  EXPECT_EQ(kModelMagic, 0x444D524Bu);
  EXPECT_EQ(kModelVersion, 1);
  EXPECT_EQ(kLegJoints, 6u);
  EXPECT_EQ(static_cast<std::size_t>(JointRole::kRightElbow) + 1, kRoleCount);
  EXPECT_EQ(static_cast<int>(JointRole::kOther), 0);
  EXPECT_EQ(leg_role(hal::Side::kLeft, 5), JointRole::kLeftAnkleRoll);
  EXPECT_EQ(leg_role(hal::Side::kRight, 0), JointRole::kRightHipYaw);
}

// A model that nobody has loaded has no joint.
TEST(ModelNumbers, AreNeutralAtFirst) {
  const Model model;
  EXPECT_EQ(model.id, 0u);
  EXPECT_EQ(model.joint_count, 0u);
  EXPECT_EQ(model.name[0], '\0');
  const Joint joint;
  EXPECT_EQ(joint.role, JointRole::kOther);
  EXPECT_EQ(joint.mirror_sign, 1);
  EXPECT_EQ(joint.drive.node_id, 0);
  EXPECT_EQ(joint.drive.sign, 1);
  EXPECT_EQ(joint.drive.position_bits, 20);
  EXPECT_EQ(joint.drive.vendor_id, 0u);
  EXPECT_EQ(joint.drive.product_code, 0u);
  EXPECT_EQ(joint.drive.serial_number, 0u);
}

}  // namespace
}  // namespace koboshi::robot
