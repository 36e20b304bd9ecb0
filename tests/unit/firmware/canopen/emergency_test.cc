#include "firmware/canopen/emergency.h"

#include <gtest/gtest.h>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

std::uint32_t history(const ErrorLog& log, std::uint8_t subindex) {
  ObjectValue value;
  EXPECT_EQ(log.read_history(subindex, value), AbortCode::kNone);
  return value.number();
}

TEST(ErrorLog, ReportsAnErrorOnceUntilItIsCleared) {
  ErrorLog log;
  EXPECT_TRUE(log.raise(0x2310, error_register::kCurrent, 0));
  EXPECT_FALSE(log.raise(0x2310, error_register::kCurrent, 0));
  EXPECT_TRUE(log.clear(0x2310));
  EXPECT_FALSE(log.clear(0x2310));
  EXPECT_TRUE(log.raise(0x2310, error_register::kCurrent, 0));
}

TEST(ErrorLog, CombinesTheRegisterOfAllActiveErrors) {
  ErrorLog log;
  EXPECT_EQ(log.error_register(), 0);
  log.raise(0x2310, error_register::kCurrent, 0);
  log.raise(0x8130, error_register::kCommunication, 0);
  EXPECT_EQ(log.error_register(), 0x13);
  log.clear(0x2310);
  EXPECT_EQ(log.error_register(), 0x11);
  log.clear(0x8130);
  EXPECT_EQ(log.error_register(), 0);
}

TEST(ErrorLog, KeepsTheNewestErrorsFirst) {
  ErrorLog log;
  EXPECT_EQ(history(log, 0), 0u);
  for (std::uint16_t code = 1; code <= 10; ++code) {
    log.raise(code, 0, static_cast<std::uint16_t>(0x100 + code));
    log.clear(code);
  }
  EXPECT_EQ(history(log, 0), ErrorLog::kHistory);
  EXPECT_EQ(history(log, 1), 0x010A000Au);
  EXPECT_EQ(history(log, 8), 0x01030003u);
}

TEST(ErrorLog, HistoryIsErasedByZeroOnly) {
  ErrorLog log;
  log.raise(0x2310, 0, 0);
  EXPECT_EQ(log.write_history(0, 1), AbortCode::kInvalidValue);
  EXPECT_EQ(log.write_history(1, 0), AbortCode::kWriteOfReadOnly);
  EXPECT_EQ(history(log, 0), 1u);
  EXPECT_EQ(log.write_history(0, 0), AbortCode::kNone);
  EXPECT_EQ(history(log, 0), 0u);
  ObjectValue value;
  EXPECT_EQ(log.read_history(1, value), AbortCode::kNoData);
  EXPECT_EQ(log.read_history(9, value), AbortCode::kSubindexDoesNotExist);
  EXPECT_TRUE(log.active(0x2310));
}

TEST(ErrorLog, StaysDefinedWithMoreErrorsThanItCanTrack) {
  ErrorLog log;
  for (std::uint16_t code = 1; code <= 20; ++code) EXPECT_TRUE(log.raise(code, 0, 0));
  EXPECT_TRUE(log.raise(20, 0, 0));
  EXPECT_FALSE(log.clear(20));
  EXPECT_TRUE(log.clear(1));
}

TEST(NodeEmergency, SendsTheErrorAndItsEnd) {
  TestNode device;
  device.make_operational();
  device.node.raise_error(0x2310, error_register::kCurrent, {1, 2, 3, 4, 5});
  device.node.raise_error(0x2310, error_register::kCurrent, {1, 2, 3, 4, 5});
  device.node.clear_error(0x2310);
  device.node.clear_error(0x2310);
  EXPECT_EQ(device.sink.take(), (std::vector{can_frame(0x090, {0x10, 0x23, 0x03, 1, 2, 3, 4, 5}),
                                             can_frame(0x090, {0x00, 0x00, 0x00, 0, 0, 0, 0, 0})}));
}

TEST(NodeEmergency, RecordsSilentlyInStopped) {
  TestNode device;
  device.make_operational();
  device.node.command(NmtCommand::kStop, 0);
  device.node.raise_error(0x2310, error_register::kCurrent);
  EXPECT_TRUE(device.sink.take().empty());
  EXPECT_EQ(device.node.errors().error_register(), 0x03);
}

TEST(NodeEmergency, ForwardsThoseOfOtherNodes) {
  TestNode device;
  device.make_operational();
  device.node.on_frame(can_frame(0x081, {0x30, 0x81, 0x11, 1, 0, 0, 0, 0}), 0);
  ASSERT_EQ(device.emergencies.size(), 1u);
  EXPECT_EQ(device.emergencies[0], (Emergency{1, 0x8130, 0x11, {1, 0, 0, 0, 0}}));
}

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

TEST(EmergencyProducer, AppliesANewInhibitTimeToMessagesThatWait) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.write_object({0x1015, 0}, 50'000, 2), AbortCode::kNone);  // 5 s
  device.node.raise_error(0x2310, 0);
  device.node.process(1'000);
  device.node.raise_error(0x4310, 0);
  device.node.process(20'000);
  EXPECT_EQ(device.sink.take().size(), 1u);
  ASSERT_EQ(device.node.write_object({0x1015, 0}, 300, 2), AbortCode::kNone);  // 30 ms
  device.node.process(30'999);
  EXPECT_TRUE(device.sink.take().empty());
  device.node.process(31'000);
  EXPECT_EQ(device.sink.take().size(), 1u);
}

TEST(EmergencyProducer, DropsExcessMessagesAndDiscardsAllInStopped) {
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

TEST(EmergencyProducer, ChangesItsIdentifierOnlyWhileInvalid) {
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
