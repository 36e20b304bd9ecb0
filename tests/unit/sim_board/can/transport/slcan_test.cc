#include "sim_board/can/transport/slcan.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>

namespace koboshi::sim_board {
namespace {

const hal::CanFrame kFrame{.identifier = 0x181, .size = 3, .data = {0x01, 0x2F, 0xFF}};

// The examples of the manual (CANUSB manual, "CANUSB ASCII commands").
TEST(SlcanProtocol, AnswersCommandsWithCarriageReturnAndUnknownOnesWithBell) {
  SlcanProtocol protocol;
  EXPECT_EQ(protocol.take("\r\rS8\rV\rF\rN\r"), "\rV1013\rF00\rNKBSH\r");
  EXPECT_EQ(protocol.take("G\r"), "\a");
}

TEST(SlcanProtocol, SendsOnlyWhileItsChannelIsOpen) {
  SlcanProtocol protocol;
  EXPECT_EQ(protocol.take("t10021133\r"), "\a");
  EXPECT_EQ(protocol.take("O\r"), "\r");
  EXPECT_EQ(protocol.take("O\r"), "\a");
  EXPECT_EQ(protocol.take("t10021133\r"), "z\r");
  ASSERT_EQ(protocol.frames().size(), 1u);
  EXPECT_EQ(protocol.frames()[0], (hal::CanFrame{.identifier = 0x100, .size = 2, .data = {0x11, 0x33}}));
  EXPECT_EQ(protocol.take("C\r"), "\r");
  EXPECT_EQ(protocol.take("t10021133\r"), "\a");
  EXPECT_EQ(protocol.take("L\rt1000\r"), "\r\a");
}

TEST(SlcanProtocol, ParsesCommandsReceivedInPieces) {
  SlcanProtocol protocol;
  EXPECT_EQ(protocol.take("O\rr12"), "\r");
  EXPECT_EQ(protocol.take("33"), "");
  EXPECT_EQ(protocol.take("\r"), "z\r");
  EXPECT_EQ(protocol.frames().at(0), (hal::CanFrame{.identifier = 0x123, .size = 3, .remote = true}));
}

TEST(SlcanProtocol, RejectsMalformedFrames) {
  SlcanProtocol protocol;
  protocol.take("O\r");
  for (const char* bad : {"t", "t100", "t8000", "t1009", "t10021", "t100211", "t1002113", "t10021133FF",
                          "t100xGG", "r123911", "T000001002FF", "R00000100"}) {
    EXPECT_EQ(protocol.take(std::string(bad) + "\r"), "\a") << bad;
  }
  EXPECT_TRUE(protocol.frames().empty());
  EXPECT_EQ(protocol.take(std::string(10'000, 't') + "\r"), "\a");
}

TEST(SlcanProtocol, WritesFramesAndStamps) {
  SlcanProtocol protocol;
  EXPECT_EQ(protocol.line_of(kFrame, 0), "");
  protocol.take("O\r");
  EXPECT_EQ(protocol.line_of(kFrame, 0), "t1813012FFF\r");
  EXPECT_EQ(protocol.line_of({.identifier = 0x701, .size = 1, .remote = true}, 0), "r7011\r");
  protocol.take("Z1\r");
  EXPECT_EQ(protocol.line_of(kFrame, 61'002'999), "t1813012FFF03EA\r");
}

// The kernel delivers what one end of a pseudo-terminal writes in the background, in parts of any size.
constexpr int kDelivery_ms = 5'000;
constexpr int kSilence_ms = 100;  // after which nothing more is on the way

// Returns what the host reads within this time, as soon as there is anything; else nothing.
std::string read_part(int host, int wait_ms) {
  std::array<char, 4096> part{};
  pollfd readable{.fd = host, .events = POLLIN, .revents = 0};
  const ssize_t got = ::poll(&readable, 1, wait_ms) > 0 ? ::read(host, part.data(), part.size()) : 0;
  return {part.data(), static_cast<std::size_t>(std::max<ssize_t>(got, 0))};
}

// Writes to the terminal as its host, and lets the adapter take it until it has answered as expected. Returns
// the answer, and the last frame that the adapter received meanwhile.
std::pair<std::string, std::optional<hal::CanFrame>> tell(Slcan& slcan, int host, std::string_view text,
                                                          std::size_t answer_size) {
  EXPECT_EQ(::write(host, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  std::pair<std::string, std::optional<hal::CanFrame>> answer;
  for (int waited_ms = 0; answer.first.size() < answer_size && waited_ms < kDelivery_ms; ++waited_ms) {
    while (const auto frame = slcan.receive()) answer.second = frame;
    answer.first += read_part(host, 1);
  }
  return answer;
}

TEST(Slcan, IsATerminalForHosts) {
  Slcan slcan;
  EXPECT_FALSE(slcan.send(kFrame, 0));  // nobody has opened the channel
  const hal::FileDescriptor host(::open(slcan.place().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
  ASSERT_GE(host.number(), 0);
  const auto [answer, frame] = tell(slcan, host.number(), "O\rt20121234\r", 3);
  EXPECT_EQ(answer, "\rz\r");
  EXPECT_EQ(frame, (hal::CanFrame{.identifier = 0x201, .size = 2, .data = {0x12, 0x34}}));
  EXPECT_EQ(slcan.receive(), std::nullopt);
  EXPECT_TRUE(slcan.send(kFrame, 0));
  const std::string line = "t1813012FFF\r";
  std::string text;
  for (std::string part;
       text.size() < line.size() && !(part = read_part(host.number(), kDelivery_ms)).empty();)
    text += part;
  EXPECT_EQ(text, line);
}

TEST(Slcan, IsNotBlockedByAHostThatDoesNotRead) {
  Slcan slcan;
  const hal::FileDescriptor host(::open(slcan.place().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
  ASSERT_EQ(tell(slcan, host.number(), "O\r", 1).first, "\r");
  int sent = 0;
  while (sent < 100'000 && slcan.send(kFrame, 0)) ++sent;
  EXPECT_LT(sent, 100'000);
  // Once it reads again, it finds whole lines.
  std::string text;
  while (!slcan.send(kFrame, 0)) text += read_part(host.number(), 0);
  for (std::string part; !(part = read_part(host.number(), kSilence_ms)).empty();) text += part;
  const std::string line = "t1813012FFF\r";
  ASSERT_EQ(text.size() % line.size(), 0u);
  for (std::size_t i = 0; i < text.size(); i += line.size()) ASSERT_EQ(text.substr(i, line.size()), line);
}

}  // namespace
}  // namespace koboshi::sim_board
