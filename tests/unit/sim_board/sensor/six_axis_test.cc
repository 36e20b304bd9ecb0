#include "sim_board/sensor/six_axis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace koboshi::sim_board {
namespace {

using Sample = SixAxis::Sample;

ChannelDescription clean_channel() {
  ChannelDescription channel;
  channel.range = 30.0;
  channel.resolution = 0.001;
  return channel;
}

ChannelDescription noisy_channel() {
  ChannelDescription channel = clean_channel();
  channel.noise_density = 0.01;
  channel.bias = 1.0;
  return channel;
}

// A signal that no straight line of the steps below cuts short.
Eigen::Vector3d ramp(std::uint64_t time_us) {
  return Eigen::Vector3d(1.0, -2.0, 0.5) * static_cast<double>(time_us) * 1e-6;
}

std::vector<Sample> run(SixAxis sensor, std::uint64_t step_us, std::uint64_t end_us) {
  std::vector<Sample> samples;
  for (std::uint64_t time_us = 0; time_us <= end_us; time_us += step_us) {
    sensor.step(ramp(time_us), -ramp(time_us), time_us);
    Sample sample;
    while (sensor.poll(time_us, sample)) samples.push_back(sample);
  }
  return samples;
}

SixAxis make(const ChannelDescription& channel, SensorErrors errors = {}) {
  return SixAxis(channel, channel, "imu.gyro", "imu.accelerometer", "imu", errors);
}

bool equal(const Sample& a, const Sample& b) {
  return a.time_us == b.time_us && a.first_raw == b.first_raw && a.second_raw == b.second_raw;
}

TEST(SixAxis, SamplesAtItsPeriodForAnyPhysicsStep) {
  const std::vector<Sample> reference = run(make(clean_channel()), 1000, 120'000);
  ASSERT_EQ(reference.size(), 119u);  // those of 1 to 119 ms have arrived, 1 ms later, by 120 ms
  EXPECT_EQ(reference.front().time_us, 1000u);
  EXPECT_EQ(reference.back().time_us, 119'000u);
  for (const std::uint64_t step_us : {100u, 250u, 375u, 4000u}) {
    const std::vector<Sample> samples = run(make(clean_channel()), step_us, 120'000);
    ASSERT_EQ(samples.size(), reference.size()) << step_us;
    for (std::size_t i = 0; i < samples.size(); ++i)
      EXPECT_TRUE(equal(samples[i], reference[i])) << step_us << ' ' << i;
  }
}

TEST(SixAxis, LagsBehindARampByTheFilter) {
  const std::vector<Sample> samples = run(make(clean_channel()), 1000, 1'000'000);
  const double lag_s = 1.0 / (std::numbers::sqrt2 * std::numbers::pi * 98.0);
  const double expected = static_cast<double>(samples.back().time_us) * 1e-6 - lag_s;
  EXPECT_NEAR(samples.back().first_raw[0] * 0.001, expected, 0.0005);
  EXPECT_NEAR(samples.back().second_raw[1] * 0.001, 2.0 * expected, 0.0005);
}

TEST(SixAxis, DeliversTheDelayAfterTheSamplingInstant) {
  ChannelDescription channel = clean_channel();
  channel.delay_s = 0.001237;
  SixAxis sensor = make(channel);
  sensor.step(ramp(0), ramp(0), 0);
  sensor.step(ramp(1000), ramp(1000), 1000);
  Sample sample;
  EXPECT_FALSE(sensor.poll(2236, sample));
  ASSERT_TRUE(sensor.poll(2237, sample));
  EXPECT_EQ(sample.time_us, 1000u);
}

TEST(SixAxis, IsReproducibleForASeed) {
  const std::vector<Sample> a = run(make(noisy_channel(), {.seed = 5}), 1000, 50'000);
  const std::vector<Sample> b = run(make(noisy_channel(), {.seed = 5}), 1000, 50'000);
  const std::vector<Sample> other = run(make(noisy_channel(), {.seed = 6}), 1000, 50'000);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_TRUE(equal(a[i], b[i]));
  EXPECT_NE(a.front().first_raw, other.front().first_raw);
}

TEST(SixAxis, DrawsIndependentlyOfOtherSensors) {
  const ChannelDescription quiet = clean_channel();
  const std::vector<Sample> both = run(make(noisy_channel(), {.seed = 5}), 1000, 50'000);
  const SixAxis half(noisy_channel(), quiet, "imu.gyro", "imu.accelerometer", "imu", {.seed = 5});
  const std::vector<Sample> alone = run(half, 1000, 50'000);
  for (std::size_t i = 0; i < both.size(); ++i) EXPECT_EQ(both[i].first_raw, alone[i].first_raw);
}

TEST(SixAxis, ScalesNoiseAndBiasToZero) {
  const std::vector<Sample> scaled = run(make(noisy_channel(), {.seed = 5, .scale = 0.0}), 1000, 50'000);
  const std::vector<Sample> clean = run(make(clean_channel()), 1000, 50'000);
  for (std::size_t i = 0; i < clean.size(); ++i) EXPECT_TRUE(equal(scaled[i], clean[i]));
}

TEST(SixAxis, DeliversNothingWhileStopped) {
  SixAxis sensor = make(clean_channel());
  Sample sample;
  for (std::uint64_t time_us = 0; time_us <= 5000; time_us += 1000) sensor.step(ramp(0), ramp(0), time_us);
  sensor.set_running(false);
  EXPECT_FALSE(sensor.poll(100'000, sample));
  sensor.step(ramp(0), ramp(0), 6000);
  EXPECT_FALSE(sensor.poll(100'000, sample));
  sensor.set_running(true);
  sensor.step(ramp(0), ramp(0), 7000);
  ASSERT_TRUE(sensor.poll(8000, sample));
  EXPECT_EQ(sample.time_us, 7000u);
}

ChannelDescription jittery_channel() {
  ChannelDescription channel = clean_channel();
  channel.jitter_s = 0.0002;
  return channel;
}

// A ramp tells when it was sampled; the sensor itself tells the time at which it should have been.
TEST(SixAxis, DisplacesSamplesByItsJitter) {
  constexpr double kResolution = 1e-4;
  ChannelDescription fine = clean_channel();
  fine.resolution = kResolution;
  ChannelDescription jittery = fine;
  jittery.jitter_s = 0.0004;
  const std::vector<Sample> straight = run(make(fine), 1000, 1'000'000);
  const std::vector<Sample> samples = run(make(jittery), 1000, 1'000'000);
  ASSERT_GE(samples.size() + 1, straight.size());  // the last may be late
  double largest_s = 0.0;
  double square_s2 = 0.0;
  constexpr std::size_t kSettled = 30;  // samples until the filter follows the ramp
  for (std::size_t i = kSettled; i < samples.size(); ++i) {
    EXPECT_EQ(samples[i].time_us, straight[i].time_us);
    // The second channel's y rises by 2 a second.
    const double miss_s = 0.5 * kResolution * (samples[i].second_raw[1] - straight[i].second_raw[1]);
    largest_s = std::max(largest_s, std::abs(miss_s));
    square_s2 += miss_s * miss_s / static_cast<double>(samples.size() - kSettled);
  }
  EXPECT_LE(largest_s, 0.0004 + 0.5 * kResolution);
  EXPECT_GT(largest_s, 0.00035);
  const double count_s2 = 0.25 * kResolution * kResolution / 6.0;  // two roundings
  const double expected_s2 = 0.0004 * 0.0004 / 3.0 + count_s2;
  EXPECT_NEAR(square_s2 / expected_s2, 1.0, 4.0 * std::sqrt(0.8 / 970.0));
}

TEST(SixAxis, DrawsTheSameJitterForAnyPhysicsStep) {
  ChannelDescription channel = jittery_channel();
  channel.jitter_s = 0.00049;
  channel.resolution = 0.0001;
  channel.delay_s = 0.002;
  const std::vector<Sample> reference = run(make(channel), 1000, 120'000);
  ASSERT_EQ(reference.size(), 118u);
  for (const std::uint64_t step_us : {100u, 250u, 375u, 4000u}) {
    const std::vector<Sample> samples = run(make(channel), step_us, 120'000);
    ASSERT_EQ(samples.size(), reference.size()) << step_us;
    for (std::size_t i = 0; i < samples.size(); ++i)
      EXPECT_TRUE(equal(samples[i], reference[i])) << step_us << ' ' << i;
  }
}

TEST(SixAxis, ScalesJitterWithoutReorderingSamples) {
  const std::vector<Sample> clean = run(make(clean_channel()), 1000, 50'000);
  const std::vector<Sample> still = run(make(jittery_channel(), {.scale = 0.0}), 1000, 50'000);
  for (std::size_t i = 0; i < clean.size(); ++i) EXPECT_TRUE(equal(still[i], clean[i]));
  const std::vector<Sample> wild = run(make(jittery_channel(), {.scale = 100.0}), 1000, 50'000);
  ASSERT_GE(wild.size() + 1, clean.size());
  for (std::size_t i = 1; i < wild.size(); ++i) EXPECT_GE(wild[i].second_raw[1], wild[i - 1].second_raw[1]);
}

TEST(SixAxis, RejectsChannelsOfDifferentClocks) {
  ChannelDescription slow = clean_channel();
  slow.sample_period_s = 0.002;
  EXPECT_THROW(SixAxis(clean_channel(), slow, "a", "b", "ab", {}), std::invalid_argument);
  ChannelDescription late = clean_channel();
  late.delay_s = 0.002;
  EXPECT_THROW(SixAxis(clean_channel(), late, "a", "b", "ab", {}), std::invalid_argument);
  ChannelDescription restless = clean_channel();
  restless.jitter_s = 0.0001;
  EXPECT_THROW(SixAxis(clean_channel(), restless, "a", "b", "ab", {}), std::invalid_argument);
}

}  // namespace
}  // namespace koboshi::sim_board
