#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <system_error>

#include "sim_board/can/transport/transport.h"

namespace koboshi::sim_board {
namespace {

std::string complaint(const std::string& name, const TransportOptions& options = {}) {
  try {
    open_transport(name, options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing";
}

TEST(OpenTransport, AcceptsNoneAndSlcan) {
  EXPECT_EQ(open_transport("none"), nullptr);
  const auto slcan = open_transport("slcan");
  EXPECT_TRUE(slcan->is_live());
  EXPECT_THAT(slcan->place(), testing::StartsWith("/dev/pts/"));
}

TEST(OpenTransport, ListsWhatItExpects) {
  for (const char* name : {"", "can0", "socketcan", "socketcan:", "serial:/dev/ttyUSB0", "log:"}) {
    EXPECT_EQ(complaint(name),
              "found the CAN transport '" + std::string(name) +
                  "', expected none, socketcan:INTERFACE, udp:GROUP:PORT, slcan or log:FILE");
  }
  for (const char* name :
       {"udp:239.74.163.2", "udp:239.74.163.2:", "udp:239.74.163.2:0", "udp:239.74.163.2:70000",
        "udp:ff15::1:43113", "udp:[ff15::1]", "udp:[239.74.163.2]:43113"}) {
    EXPECT_EQ(complaint(name), std::string(name) + " is not udp:GROUP:PORT, such as udp:239.74.163.2:43113");
  }
  EXPECT_EQ(complaint("udp:10.0.0.1:43113"), "10.0.0.1 is no multicast address, such as 239.74.163.2");
  EXPECT_EQ(complaint("udp:[fd00::1]:43113"), "fd00::1 is no multicast address, such as 239.74.163.2");
}

TEST(OpenTransport, RefusesOptionsOfAnotherTransport) {
  EXPECT_EQ(complaint("none", {.ttl = 1}),
            "found --ttl with the CAN transport 'none', expected udp:GROUP:PORT");
  EXPECT_EQ(complaint("socketcan:vcan0", {.interface = "lo"}),
            "found --interface with the CAN transport 'socketcan:vcan0', expected udp:GROUP:PORT");
  EXPECT_EQ(complaint("udp:239.74.163.2:43113", {.interface = "nosuch0"}),
            "found --interface nosuch0, expected a network interface, as `ip link` lists them");
}

// Whatever it is that the machine lacks, the interface or CAN itself, the name of the interface is told.
TEST(OpenTransport, ReportsTheErrorOfTheSystem) {
  try {
    open_transport("socketcan:nocan0", {.real_bus = true});
    FAIL();
  } catch (const std::system_error& error) {
    EXPECT_THAT(error.what(), testing::AnyOf(testing::HasSubstr("nocan0"), testing::HasSubstr("SocketCAN")));
  }
}

TEST(OpenTransport, RejectsAnInterfaceThatMayBePhysical) {
  EXPECT_THAT(complaint("socketcan:lo"), testing::HasSubstr("--real-bus"));
}

}  // namespace
}  // namespace koboshi::sim_board
