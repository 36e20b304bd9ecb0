#include "sim_board/can/transport/udp_multicast.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <string_view>

namespace koboshi::sim_board {
namespace {

// The bytes that pack_message of python-can 4.1 makes of Message(arbitration_id=0x181, data=[1, 2, 255],
// is_extended_id=False, timestamp=1.5).
constexpr std::string_view kDataOfPython =
    "8ba974696d657374616d70cb3ff8000000000000ae6172626974726174696f6e5f6964cd0181ae69735f657874"
    "656e6465645f6964c2af69735f72656d6f74655f6672616d65c2ae69735f6572726f725f6672616d65c2a76368"
    "616e6e656cc0a3646c6303a464617461c4030102ffa569735f6664c2ae626974726174655f737769746368c2b5"
    "6572726f725f73746174655f696e64696361746f72c2";
// And of Message(arbitration_id=0x701, dlc=1, is_remote_frame=True, is_extended_id=False).
constexpr std::string_view kRemoteOfPython =
    "8ba974696d657374616d70cb0000000000000000ae6172626974726174696f6e5f6964cd0701ae69735f657874"
    "656e6465645f6964c2af69735f72656d6f74655f6672616d65c3ae69735f6572726f725f6672616d65c2a76368"
    "616e6e656cc0a3646c6301a464617461c400a569735f6664c2ae626974726174655f737769746368c2b5657272"
    "6f725f73746174655f696e64696361746f72c2";

const hal::CanFrame kData{.identifier = 0x181, .size = 3, .data = {1, 2, 255}};
const hal::CanFrame kRemote{.identifier = 0x701, .size = 1, .remote = true};

std::vector<std::uint8_t> bytes_of(std::string_view hex) {
  std::vector<std::uint8_t> bytes(hex.size() / 2);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    std::from_chars(hex.data() + 2 * i, hex.data() + 2 * i + 2, bytes[i], 16);
  return bytes;
}

TEST(Datagram, IsReadAsPythonWritesIt) {
  EXPECT_EQ(unpack_datagram(bytes_of(kDataOfPython)), BusFrame(kData));
  EXPECT_EQ(unpack_datagram(bytes_of(kRemoteOfPython)), BusFrame(kRemote));
}

TEST(Datagram, IsWrittenAsPythonWritesIt) {
  EXPECT_TRUE(std::ranges::equal(pack_datagram(kData, 1.5).view(), bytes_of(kDataOfPython)));
  EXPECT_TRUE(std::ranges::equal(pack_datagram(kRemote, 0.0).view(), bytes_of(kRemoteOfPython)));
}

TEST(Datagram, RoundTrips) {
  for (std::uint16_t identifier = 0; identifier < 0x800; ++identifier) {
    for (std::uint8_t size = 0; size <= 8; ++size) {
      hal::CanFrame frame{.identifier = identifier, .size = size};
      for (std::uint8_t i = 0; i < size; ++i) frame.data[i] = static_cast<std::uint8_t>(identifier + 31 * i);
      ASSERT_EQ(unpack_datagram(pack_datagram(frame, 1.7e9).view()), BusFrame(frame));
    }
  }
}

// Else those of one millisecond would not make a train. The largest fill their place.
TEST(Datagram, HasALengthThatDependsOnItsDataOnly) {
  for (std::uint8_t size = 0; size <= 8; ++size) {
    const std::size_t expected = pack_datagram({.identifier = 0x7FF, .size = size}, 1.5).size;
    for (const int identifier : {0x000, 0x07F, 0x080, 0x0FF, 0x100})
      EXPECT_EQ(pack_datagram({.identifier = static_cast<std::uint16_t>(identifier), .size = size}, 0.0).size,
                expected);
  }
  EXPECT_EQ(pack_datagram({.size = 8}, 0.0).size, Datagram::kCapacity_bytes);
}

TEST(Datagram, IsRejectedUnlessItIsAFrame) {
  EXPECT_EQ(unpack_datagram({}), std::nullopt);
  const std::vector<std::uint8_t> whole = bytes_of(kDataOfPython);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_EQ(unpack_datagram(std::span(whole).first(size)), std::nullopt) << size;
  std::vector<std::uint8_t> longer = whole;  // dlc 4 of 3 bytes
  longer[100] = 0x04;
  EXPECT_EQ(unpack_datagram(longer), std::nullopt);
}

// The same bytes with other marks: a 29-bit identifier, an error frame, CAN FD.
TEST(Datagram, MayHoldAForeignFrame) {
  const auto kind_with = [](std::string_view mark) -> std::optional<ForeignFrame::Kind> {
    std::vector<std::uint8_t> datagram = bytes_of(kDataOfPython);
    const auto name = std::ranges::search(datagram, mark);
    *name.end() = 0xC3;  // true
    const auto frame = unpack_datagram(datagram);
    if (!frame || !std::holds_alternative<ForeignFrame>(*frame)) return std::nullopt;
    return std::get<ForeignFrame>(*frame).kind;
  };
  EXPECT_EQ(kind_with("is_extended_id"), ForeignFrame::Kind::kExtended);
  EXPECT_EQ(kind_with("is_error_frame"), ForeignFrame::Kind::kError);
  EXPECT_EQ(kind_with("is_fd"), ForeignFrame::Kind::kFd);
}

// Whatever each byte of a datagram is, nothing worse happens than that it is none.
TEST(Datagram, SurvivesArbitraryBytes) {
  const std::vector<std::uint8_t> whole = bytes_of(kDataOfPython);
  for (std::size_t place = 0; place < whole.size(); ++place) {
    for (int value = 0; value < 256; ++value) {
      std::vector<std::uint8_t> changed = whole;
      changed[place] = static_cast<std::uint8_t>(value);
      const auto frame = unpack_datagram(changed);
      if (!frame) continue;
      if (const auto* standard = std::get_if<hal::CanFrame>(&*frame)) {
        EXPECT_LE(standard->size, 8);
      } else {
        EXPECT_LE(std::get<ForeignFrame>(*frame).size, ForeignFrame::kMaxBytes);
      }
    }
  }
}

TEST(UdpMulticast, RejectsAnInvalidGroup) {
  EXPECT_THROW(UdpMulticast("10.0.0.1", 43113), std::invalid_argument);
  EXPECT_THROW(UdpMulticast("somewhere", 43113), std::invalid_argument);
}

}  // namespace
}  // namespace koboshi::sim_board
