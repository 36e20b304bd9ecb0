// Members of a multicast group in one process. Needs a network with a multicast route: see in_network.sh.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <vector>

#include "hal/linux/file_descriptor.h"
#include "sim_board/can/transport/udp_multicast.h"

namespace koboshi::sim_board {
namespace {

constexpr const char* kGroup = "239.74.163.2";
constexpr std::uint16_t kPort = 43113;

// Returns as many frames as a walk sends in half a second, of all sizes.
std::vector<hal::CanFrame> frames_of_all_sizes() {
  std::vector<hal::CanFrame> frames;
  for (unsigned i = 0; i < 2'500; ++i) {
    hal::CanFrame frame{.identifier = static_cast<std::uint16_t>(i % 0x800),
                        .size = static_cast<std::uint8_t>(i * i / 64 % 9)};
    for (std::uint8_t byte = 0; byte < frame.size; ++byte)
      frame.data[byte] = static_cast<std::uint8_t>(i + byte);
    frames.push_back(frame);
  }
  return frames;
}

TEST(UdpMulticast, ReachesOtherSocketsInOrderButNotItsOwn) {
  UdpMulticast one(kGroup, kPort);
  UdpMulticast other(kGroup, kPort);
  UdpMulticast third(kGroup, kPort);
  const std::vector<hal::CanFrame> frames = frames_of_all_sizes();
  std::vector<hal::CanFrame> heard;
  std::size_t sent = 0;
  for (std::size_t burst = 1; sent < frames.size(); burst = burst % 100 + 1) {  // also bursts longer than one
                                                                                // batch
    for (std::size_t i = 0; i < burst && sent < frames.size(); ++i) ASSERT_TRUE(one.send(frames[sent++], 0));
    one.flush();
    while (const auto frame = other.receive()) heard.push_back(*frame);
    ASSERT_EQ(one.receive(), std::nullopt);
  }
  EXPECT_EQ(heard, frames);
  ASSERT_TRUE(other.send(frames[9], 0));
  EXPECT_EQ(one.receive(), std::nullopt) << "before the flush";
  other.flush();
  EXPECT_EQ(one.receive(), frames[9]);
  std::size_t heard_by_third = 0;
  while (third.receive()) ++heard_by_third;
  EXPECT_EQ(heard_by_third, frames.size() + 1);
}

// A program that sends a frame with an ordinary socket.
void send_to(const char* host, const hal::CanFrame& frame) {
  const hal::FileDescriptor socket(hal::checked(::socket(AF_INET, SOCK_DGRAM, 0), "a UDP socket"));
  sockaddr_in there{};
  there.sin_family = AF_INET;
  there.sin_port = htons(kPort);
  ASSERT_EQ(inet_pton(AF_INET, host, &there.sin_addr), 1);
  const Datagram datagram = pack_datagram(frame, 0.0);
  ASSERT_EQ(::sendto(socket.number(), datagram.bytes.data(), datagram.size, 0,
                     reinterpret_cast<const sockaddr*>(&there), sizeof there),
            static_cast<ssize_t>(datagram.size));
}

TEST(UdpMulticast, HearsNeitherOtherGroupsNorUnicast) {
  UdpMulticast ours(kGroup, kPort);
  UdpMulticast other("239.74.163.3", kPort);
  const hal::CanFrame stop{.identifier = 0x201, .size = 3, .data = {5}};
  send_to("127.0.0.1", stop);
  EXPECT_EQ(ours.receive(), std::nullopt);
  EXPECT_EQ(other.receive(), std::nullopt);
  send_to("239.74.163.3", stop);
  EXPECT_EQ(ours.receive(), std::nullopt);
  EXPECT_EQ(other.receive(), stop);
  send_to(kGroup, stop);
  EXPECT_EQ(ours.receive(), stop);
  EXPECT_EQ(other.receive(), std::nullopt);
}

}  // namespace
}  // namespace koboshi::sim_board
