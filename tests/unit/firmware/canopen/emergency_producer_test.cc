#include "firmware/canopen/emergency_producer.h"

#include <gtest/gtest.h>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

TEST(EmergencyProducer, SpacesMessagesByTheInhibitTime) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.write_object({0x1015, 0}, 100, 2), AbortCode::kNone);  // 10 ms
  device.node.raise_error(0x2310, 0);
  device.node.raise_error(0x4310, 0);
  device.node.process(1'000);
  EXPECT_EQ(device.sink.take(), std::vector{can_frame(0x090, {0x10, 0x23, 0x01, 0, 0, 0, 0, 0})});
  device.node.process(10'999);
  EXPECT_TRUE(device.sink.take().empty());
  device.node.process(11'000);
  EXPECT_EQ(device.sink.take(), std::vector{can_frame(0x090, {0x10, 0x43, 0x01, 0, 0, 0, 0, 0})});
}

TEST(EmergencyProducer, DropsWhatIsTooMuchAndForgetsAllInStopped) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.write_object({0x1015, 0}, 1, 2), AbortCode::kNone);
  for (std::uint16_t code = 1; code <= 12; ++code) device.node.raise_error(code, 0);
  for (std::uint64_t now_us = 1'000; now_us <= 20'000; now_us += 1'000) device.node.process(now_us);
  EXPECT_EQ(device.sink.take().size(), EmergencyProducer::kPending);
  device.node.raise_error(0x2310, 0);
  device.node.command(NmtCommand::kStop, 21'000);
  device.node.command(NmtCommand::kStart, 21'000);
  device.node.process(30'000);
  EXPECT_TRUE(device.sink.take().empty());
}

TEST(EmergencyProducer, ChangesItsIdentifierOnlyWhileItHasNone) {
  TestNode device;
  device.make_operational();
  EXPECT_EQ(device.node.write_object({0x1014, 0}, 0x0A0, 4), AbortCode::kInvalidValue);
  ASSERT_EQ(device.node.write_object({0x1014, 0}, 0x8000'0090, 4), AbortCode::kNone);
  device.node.raise_error(0x2310, 0);
  EXPECT_TRUE(device.sink.take().empty());
  EXPECT_EQ(device.node.write_object({0x1014, 0}, 0x601, 4), AbortCode::kInvalidValue);
  ASSERT_EQ(device.node.write_object({0x1014, 0}, 0x0A0, 4), AbortCode::kNone);
  device.node.clear_error(0x2310);
  EXPECT_EQ(device.sink.take(), std::vector{can_frame(0x0A0, {0, 0, 0, 0, 0, 0, 0, 0})});
}

}  // namespace
}  // namespace koboshi::canopen
