#include "tools/target/parts.h"

#include <gtest/gtest.h>

namespace koboshi::tools {
namespace {

TEST(PartOf, FollowsTheNamespaceOfAFunction) {
  EXPECT_EQ(part_of("canopen::Node::on_frame"), Part::kCanopen);
  EXPECT_EQ(part_of("drive::DriveGroup::observe"), Part::kDrives);
  EXPECT_EQ(part_of("motion::Interpreter::advance"), Part::kInterpreter);
  EXPECT_EQ(part_of("app::Controller::tick"), Part::kBehaviour);
}

TEST(PartOf, SeparatesSensorReadingFromEstimation) {
  EXPECT_EQ(part_of("estimation::InertialSensor::add"), Part::kSensors);
  EXPECT_EQ(part_of("app::Controller::read_ankles"), Part::kSensors);
  EXPECT_EQ(part_of("estimation::InertialSensor::pitch"), Part::kEstimation);
}

TEST(PartOf, IsEmptyForSharedHelpers) {
  EXPECT_EQ(part_of("fixed::atan2_raw"), std::nullopt);
  EXPECT_EQ(part_of("hal::BatchBoard::transmit"), std::nullopt);
  EXPECT_EQ(part_of("__aeabi_ldivmod"), std::nullopt);
}

}  // namespace
}  // namespace koboshi::tools
