#include "bus/can/export.h"

#include <gtest/gtest.h>

namespace koboshi::bus {
namespace {

TimedFrame frame_of(const std::string& notation, const std::string& interface = "can0",
                    sim_board::Direction direction = sim_board::Direction::kUnknown) {
  return {sim_board::parse_frame_notation(notation).value(), 1'700'000'000'123'456, interface, direction};
}

TEST(Export, WritesRowsOfATable) {
  EXPECT_EQ(csv_head(), "time_s,interface,direction,identifier,format,remote,size,data,description\n");
  EXPECT_EQ(csv_row(frame_of("181#0102", "can0", sim_board::Direction::kSent), "a, b"),
            "1700000000.123456,can0,T,181,standard,0,2,0102,\"a, b\"\n");
  EXPECT_EQ(csv_row(frame_of("18FEF100#R8"), ""), "1700000000.123456,can0,,18FEF100,extended,1,8,,\n");
  EXPECT_EQ(csv_row(frame_of("123##1AA"), ""), "1700000000.123456,can0,,123,fd,0,1,AA,\n");
}

// As log2asc of can-utils writes them, with the times of the log.
TEST(Export, WritesLinesOfVectorsFormat) {
  AscWriter asc;
  const std::string time = "1700000000.123456 ";
  EXPECT_EQ(asc.line(frame_of("123#1122334455667788")),
            time + "1  123             Rx   d 8 11 22 33 44 55 66 77 88\n");
  EXPECT_EQ(asc.line(frame_of("18FEF100#0102", "can1")), time + "2  18FEF100x       Rx   d 2 01 02\n");
  EXPECT_EQ(asc.line(frame_of("7FF#R")), time + "1  7FF             Rx   r 0\n");
  EXPECT_EQ(asc.line(frame_of("123#0011", "can0", sim_board::Direction::kSent)),
            time + "1  123             Tx   d 2 00 11\n");
  EXPECT_EQ(asc.line(frame_of("20000004#0001000000000000")), time + "1  ErrorFrame\n");
  EXPECT_EQ(asc.line(frame_of("18FEF100##3112233445566778899AABBCC")),
            time +
                "CANFD   1 Rx     18FEF100x                                  1 1 9 12 11 22 33 44 55 66 77 "
                "88 99 AA BB "
                "CC        0    0     7000 0 0 0 0 0\n");
  EXPECT_EQ(asc.line(frame_of("123#81:00:12345678#11")), "");
}

TEST(Export, GivesEachInterfaceItsChannel) {
  AscWriter asc;
  const auto channel = [&](const std::string& interface) {
    return asc.line(frame_of("080#", interface))[18];
  };
  EXPECT_EQ(channel("can2"), '3');
  EXPECT_EQ(channel("vcan0"), '1');
  EXPECT_EQ(channel("can0"), '2');
  EXPECT_EQ(channel("bus"), '4');
  EXPECT_EQ(channel("can2"), '3');
}

}  // namespace
}  // namespace koboshi::bus
