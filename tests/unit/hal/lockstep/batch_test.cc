#include "hal/lockstep/batch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <span>
#include <vector>

namespace koboshi::hal {
namespace {

using Bytes = std::vector<std::byte>;

template <typename Message>
Bytes encoded(const Message& message) {
  Bytes bytes(kMaxBatchInputBytes);
  bytes.resize(encode(message, std::span(bytes)));
  return bytes;
}

CanFrame random_frame(std::mt19937& random) {
  CanFrame frame;
  frame.identifier = static_cast<std::uint16_t>(random() & 0x7FF);
  frame.size = static_cast<std::uint8_t>(random() % 9);
  frame.remote = (random() & 1) != 0;
  for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
  return frame;
}

std::array<std::int16_t, 3> random_axes(std::mt19937& random) {
  std::array<std::int16_t, 3> axes;
  for (auto& axis : axes) axis = static_cast<std::int16_t>(random());
  return axes;
}

BatchInput random_input(std::mt19937& random, std::size_t frames, std::size_t samples) {
  BatchInput input;
  input.now_us = (std::uint64_t{random()} << 32) | random();
  input.tick = (random() & 1) != 0;
  input.can_status = {.state = static_cast<CanErrorState>(random() % 3),
                      .transmit_error_count = static_cast<std::uint8_t>(random()),
                      .receive_error_count = static_cast<std::uint8_t>(random()),
                      .receive_overruns = static_cast<std::uint16_t>(random())};
  for (std::uint16_t& space : input.transmit_space) space = static_cast<std::uint16_t>(random());
  for (bool& pending : input.transmit_pending) pending = (random() & 1) != 0;
  input.imu_overruns = static_cast<std::uint16_t>(random());
  for (std::size_t i = 0; i < frames; ++i) EXPECT_TRUE(input.frames.push(random_frame(random)));
  for (std::size_t i = 0; i < samples; ++i) {
    const auto time_us = static_cast<std::uint32_t>(random());
    EXPECT_TRUE(input.imu.push({time_us, random_axes(random), random_axes(random)}));
  }
  for (std::size_t side = 0; side < 2; ++side) {
    input.ankle_fresh[side] = (random() & 1) != 0;
    input.ankles[side] = {static_cast<std::uint32_t>(random()), random_axes(random), random_axes(random)};
  }
  return input;
}

void expect_equal(const BatchInput& a, const BatchInput& b) {
  EXPECT_EQ(a.now_us, b.now_us);
  EXPECT_EQ(a.tick, b.tick);
  EXPECT_EQ(a.can_status, b.can_status);
  EXPECT_EQ(a.transmit_space, b.transmit_space);
  EXPECT_EQ(a.transmit_pending, b.transmit_pending);
  EXPECT_EQ(a.imu_overruns, b.imu_overruns);
  EXPECT_TRUE(std::ranges::equal(a.frames.view(), b.frames.view()));
  EXPECT_TRUE(std::ranges::equal(a.imu.view(), b.imu.view()));
  EXPECT_EQ(a.ankle_fresh, b.ankle_fresh);
  EXPECT_EQ(a.ankles, b.ankles);
}

TEST(BatchInput, RoundTripsAtEveryFillLevel) {
  std::mt19937 random(1);
  for (std::size_t frames = 0; frames <= BatchInput::kMaxFrames; ++frames) {
    const std::size_t samples = frames % (BatchInput::kMaxImuSamples + 1);
    const BatchInput sent = random_input(random, frames, samples);
    BatchInput received = random_input(random, 3, 3);  // the decoder must overwrite all earlier contents
    ASSERT_TRUE(decode(encoded(sent), received));
    expect_equal(sent, received);
  }
}

TEST(BatchInput, FillsTheLargestMessageExactly) {
  std::mt19937 random(2);
  const BatchInput full = random_input(random, BatchInput::kMaxFrames, BatchInput::kMaxImuSamples);
  EXPECT_EQ(encoded(full).size(), kMaxBatchInputBytes);
}

TEST(BatchInput, HasThisWireFormat) {
  BatchInput input;
  input.now_us = 0x0102030405060708;
  input.tick = true;
  input.can_status = {CanErrorState::kErrorPassive, 0x11, 0x22, 0x3344};
  input.transmit_space = {0x0040, 0x0720, 0x0810};
  input.transmit_pending = {false, true, false};
  input.imu_overruns = 0x5566;
  ASSERT_TRUE(input.frames.push({.identifier = 0x7A1, .size = 3, .remote = true, .data = {1, 2, 3}}));
  const Bytes bytes = encoded(input);
  const std::vector<int> expected = {
      8,    7,    6,    5,    4,    3,    2, 1,                 // now_us
      1,                                                        // tick
      1,    0x11, 0x22, 0x44, 0x33,                             // can_status
      0x40, 0x00, 0x20, 0x07, 0x10, 0x08,                       // transmit_space
      0,    1,    0,                                            // transmit_pending
      0x66, 0x55,                                               // imu_overruns
      1,    0,    0xA1, 0x07, 0x83, 1,    2, 3, 0, 0, 0, 0, 0,  // one remote frame, size 3
      0,    0,                                                  // no IMU sample
      0,    0,                                                  // no fresh ankle
  };
  ASSERT_EQ(bytes.size(), expected.size() + 2 * 16);
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(std::to_integer<int>(bytes[i]), expected[i]) << i;
}

TEST(BatchInput, IsRejectedWhenCutAnywhereOrTooLong) {
  std::mt19937 random(3);
  Bytes bytes = encoded(random_input(random, 5, 4));
  BatchInput input;
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_FALSE(decode(std::span(bytes).first(length), input)) << length;
  }
  bytes.push_back(std::byte{0});
  EXPECT_FALSE(decode(bytes, input));
}

TEST(BatchInput, IsRejectedWithAValueOutOfRange) {
  BatchInput input;
  ASSERT_TRUE(input.frames.push({.identifier = 0x123, .size = 8}));
  const Bytes good = encoded(input);
  const auto decodes_with = [&good](std::size_t offset, int value) {
    Bytes bytes = good;
    bytes[offset] = static_cast<std::byte>(value);
    BatchInput decoded;
    return decode(bytes, decoded);
  };
  EXPECT_TRUE(decodes_with(8, 1));
  EXPECT_FALSE(decodes_with(8, 2)) << "tick";
  EXPECT_FALSE(decodes_with(9, 3)) << "CAN error state";
  EXPECT_FALSE(decodes_with(20, 2)) << "pending frames";
  EXPECT_FALSE(decodes_with(25, 65)) << "frame count";
  EXPECT_FALSE(decodes_with(28, 0x08)) << "identifier of 12 bits";
  EXPECT_FALSE(decodes_with(29, 9)) << "size of data";
  EXPECT_FALSE(decodes_with(29, 0x89)) << "size of a remote frame";
  EXPECT_FALSE(decodes_with(38, 17)) << "IMU sample count";
  EXPECT_FALSE(decodes_with(40, 2)) << "fresh ankle";
}

TEST(BatchInput, NeverReadsOutOfBoundsOnRandomBytes) {
  std::mt19937 random(4);
  for (int round = 0; round < 20'000; ++round) {
    std::mt19937 content(random());
    Bytes bytes = encoded(random_input(content, random() % 4, random() % 4));
    for (int i = 0; i < 3; ++i) bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    BatchInput input;
    if (!decode(bytes, input)) continue;
    ASSERT_LE(input.frames.size, BatchInput::kMaxFrames);
    ASSERT_LE(input.imu.size, BatchInput::kMaxImuSamples);
    ASSERT_EQ(encoded(input), bytes) << "accepted, so it has one encoding only";
  }
}

TEST(BatchOutput, RoundTrips) {
  std::mt19937 random(5);
  for (std::size_t frames = 0; frames <= BatchOutput::kMaxFrames; ++frames) {
    BatchOutput sent;
    for (std::size_t i = 0; i < frames; ++i) ASSERT_TRUE(sent.frames.push(random_frame(random)));
    sent.recover = (frames & 1) != 0;
    sent.watchdog_kicked = (frames & 2) != 0;
    sent.drive_enabled = (frames & 4) != 0;
    BatchOutput received;
    ASSERT_TRUE(decode(encoded(sent), received));
    EXPECT_TRUE(std::ranges::equal(sent.frames.view(), received.frames.view()));
    EXPECT_EQ(sent.recover, received.recover);
    EXPECT_EQ(sent.watchdog_kicked, received.watchdog_kicked);
    EXPECT_EQ(sent.drive_enabled, received.drive_enabled);
    EXPECT_EQ(encoded(sent).size(),
              kMaxBatchOutputBytes - (BatchOutput::kMaxFrames - frames) * kMaxFrameBytes);
  }
}

TEST(BatchOutput, IsRejectedWhenCutTooLongOrWithUnknownFlags) {
  BatchOutput output;
  ASSERT_TRUE(output.frames.push({.identifier = 0x80}));
  Bytes bytes = encoded(output);
  BatchOutput decoded;
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_FALSE(decode(std::span(bytes).first(length), decoded)) << length;
  }
  bytes.back() = std::byte{8};
  EXPECT_FALSE(decode(bytes, decoded));
  bytes.back() = std::byte{7};
  EXPECT_TRUE(decode(bytes, decoded));
  bytes.push_back(std::byte{0});
  EXPECT_FALSE(decode(bytes, decoded));
}

TEST(Encode, ReturnsZeroWhenTheBufferIsTooShort) {
  std::mt19937 random(6);
  const BatchInput input = random_input(random, 2, 2);
  const std::size_t needed = encoded(input).size();
  Bytes buffer(needed + 1, std::byte{0x77});
  EXPECT_EQ(encode(input, std::span(buffer).first(needed - 1)), 0u);
  EXPECT_EQ(buffer[needed - 1], std::byte{0x77}) << "wrote past the end";
  EXPECT_EQ(encode(input, std::span(buffer).first(needed)), needed);
  EXPECT_EQ(encode(BatchOutput{}, {}), 0u);
}

}  // namespace
}  // namespace koboshi::hal
