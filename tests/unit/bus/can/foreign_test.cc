#include <gtest/gtest.h>

#include "bus/can/describe.h"

namespace koboshi::bus {
namespace {

using Kind = sim_board::ForeignFrame::Kind;

TEST(Foreign, IsDescribedByItsFormat) {
  EXPECT_EQ(describe(sim_board::ForeignFrame{.extended = true}), "29-bit identifier");
  EXPECT_EQ(describe(sim_board::ForeignFrame{.extended = true, .remote = true}),
            "29-bit identifier, remote request");
  EXPECT_EQ(describe(sim_board::ForeignFrame{.kind = Kind::kFd, .flags = 3}),
            "CAN FD, bit rate switch, sender error passive");
  EXPECT_EQ(describe(sim_board::ForeignFrame{.kind = Kind::kFd, .extended = true}),
            "CAN FD, 29-bit identifier");
  EXPECT_EQ(describe(sim_board::ForeignFrame{.kind = Kind::kXl}), "CAN XL");
}

TEST(Foreign, DecodesErrorFrames) {
  sim_board::ForeignFrame frame{.kind = Kind::kError, .size = 8, .identifier = 0x004};
  frame.data = {0, 0x11, 0, 0, 0, 0, 130, 7};
  EXPECT_EQ(
      describe(frame),
      "error frame: controller (receive overflow, receive error passive), 130 transmit and 7 receive errors");
  frame = {.kind = Kind::kError, .size = 8, .identifier = 0x048};
  frame.data[2] = 0x04;
  EXPECT_EQ(describe(frame), "error frame: protocol violation (bit stuffing), bus-off");
}

TEST(Foreign, IsCounted) {
  ForeignCount count;
  count.add(hal::CanFrame{.identifier = 0x181});
  EXPECT_TRUE(count.empty());
  count.add(hal::CanFrame{.identifier = 0x181, .remote = true});
  count.add(sim_board::ForeignFrame{.kind = Kind::kFd});
  count.add(sim_board::ForeignFrame{.extended = true});
  count.add(sim_board::ForeignFrame{.extended = true});
  EXPECT_EQ(count.text(), "2 with 29-bit identifiers, 1 in the format of CAN FD, 1 remote frame");
}

}  // namespace
}  // namespace koboshi::bus
