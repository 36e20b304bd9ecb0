#include "sim_board/can/transport/log_transport.h"

#include <gtest/gtest.h>

#include <system_error>

#include "sim_board/can/candump_log.h"
#include "tests/unit/base/scratch_file.h"

namespace koboshi::sim_board {
namespace {

TEST(LogTransport, RoundTrips) {
  const ScratchFile scratch("log", "");
  const hal::CanFrame frame{.identifier = 0x181, .size = 2, .data = {1, 2}};
  {
    LogTransport log(scratch.path());
    EXPECT_TRUE(log.send(frame, 12'345));
    EXPECT_EQ(log.receive(), std::nullopt);
    EXPECT_FALSE(log.is_live());
  }
  CandumpReader reader(scratch.path());
  const auto logged = reader.next();
  ASSERT_TRUE(logged);
  EXPECT_EQ(logged->frame, BusFrame(frame));
  EXPECT_EQ(logged->time_us, 12'345u);
  EXPECT_EQ(reader.next(), std::nullopt);
}

TEST(LogTransport, NeedsAFileThatCanBeWritten) {
  EXPECT_THROW(LogTransport("/no/such/folder/can.log"), std::system_error);
}

}  // namespace
}  // namespace koboshi::sim_board
