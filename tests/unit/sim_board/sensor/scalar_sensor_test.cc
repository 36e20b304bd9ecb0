#include "sim_board/sensor/scalar_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace koboshi::sim_board {
namespace {

// A supply's voltage behind a divider, in 12 bits.
ScalarSensorDescription voltmeter() {
  return {.lowest = 0.0, .highest = 10.0, .resolution = 10.0 / 4096, .sample_period_s = 0.01};
}

double read(const ScalarSensorDescription& description, double value, const SensorErrors& errors = {}) {
  ScalarSensor sensor(description, "supply", errors);
  sensor.step(value, 0);
  return sensor.reading();
}

TEST(ScalarSensor, RoundsToTheNearestCount) {
  EXPECT_EQ(read(voltmeter(), 7.5), 7.5);
  const double resolution = voltmeter().resolution;
  EXPECT_DOUBLE_EQ(read(voltmeter(), 7.5 + 0.49 * resolution), 7.5);
  EXPECT_DOUBLE_EQ(read(voltmeter(), 7.5 + 0.51 * resolution), 7.5 + resolution);
}

TEST(ScalarSensor, SaturatesAtTheEndsOfItsRange) {
  ScalarSensorDescription thermometer{.lowest = -40.0, .highest = 125.0, .resolution = 0.5};
  EXPECT_EQ(read(thermometer, -60.0), -40.0);
  EXPECT_EQ(read(thermometer, 24.8), 25.0);
  EXPECT_EQ(read(thermometer, 300.0), 125.0);
}

TEST(ScalarSensor, HasScaleErrorAndOffsetWithinTheirBounds) {
  ScalarSensorDescription description = voltmeter();
  description.resolution = 1e-9;
  description.offset = 0.05;
  double largest = 0.0;
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    largest = std::max(largest, std::abs(read(description, 5.0, {.seed = seed}) - 5.0));
  }
  EXPECT_LE(largest, 0.05 + 1e-8);
  EXPECT_GT(largest, 0.049);
  description.offset = 0.0;
  description.scale_error = 0.02;
  largest = 0.0;
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    largest = std::max(largest, std::abs(read(description, 5.0, {.seed = seed}) - 5.0));
  }
  EXPECT_LE(largest, 0.1 + 1e-8);
  EXPECT_GT(largest, 0.098);
}

TEST(ScalarSensor, HasTheSpecifiedNoise) {
  ScalarSensorDescription description = voltmeter();
  description.noise = 0.02;
  ScalarSensor sensor(description, "supply", {});
  constexpr int kSamples = 20'000;
  double mean = 0.0;
  double square = 0.0;
  for (std::uint64_t i = 0; i < kSamples; ++i) {
    sensor.step(5.0, 10'000 * i);
    mean += (sensor.reading() - 5.0) / kSamples;
    square += std::pow(sensor.reading() - 5.0, 2) / kSamples;
  }
  const double variance = 0.02 * 0.02 + description.resolution * description.resolution / 12.0;
  EXPECT_NEAR(mean, 0.0, 4.0 * std::sqrt(variance / kSamples));
  EXPECT_NEAR(square / variance, 1.0, 4.0 * std::sqrt(2.0 / kSamples));
}

TEST(ScalarSensor, HoldsBetweenSamplesForAnyPhysicsStep) {
  for (const std::uint64_t step_us : {100u, 375u, 1000u, 7000u}) {
    ScalarSensorDescription description = voltmeter();
    description.resolution = 1e-6;
    ScalarSensor sensor(description, "supply", {});
    for (std::uint64_t time_us = 0; time_us <= 105'000; time_us += step_us) {
      sensor.step(static_cast<double>(time_us) * 1e-5, time_us);
      const double sampled = static_cast<double>(time_us / 10'000 * 10'000) * 1e-5;
      ASSERT_NEAR(sensor.reading(), sampled, 1e-6) << step_us << ' ' << time_us;
    }
  }
}

TEST(ScalarSensor, IsExactExceptForRangeAndResolutionWithErrorsScaledToZero) {
  ScalarSensorDescription description = voltmeter();
  description.noise = 1.0;
  description.offset = 1.0;
  description.scale_error = 0.5;
  EXPECT_EQ(read(description, 7.5, {.scale = 0.0}), 7.5);
}

TEST(ScalarSensor, DrawsItsErrorsByName) {
  ScalarSensorDescription description = voltmeter();
  description.offset = 0.5;
  std::set<double> readings;
  for (const char* name : {"supply", "winding", "case"}) {
    ScalarSensor sensor(description, name, {.seed = 2});
    sensor.step(5.0, 0);
    readings.insert(sensor.reading());
  }
  EXPECT_EQ(readings.size(), 3u);
}

TEST(ScalarSensor, RejectsInvalidDescriptions) {
  ScalarSensorDescription description = voltmeter();
  description.resolution = 0.0;
  EXPECT_THROW(ScalarSensor(description, "supply", {}), std::invalid_argument);
  description = voltmeter();
  description.highest = description.lowest;
  EXPECT_THROW(ScalarSensor(description, "supply", {}), std::invalid_argument);
  description = voltmeter();
  description.sample_period_s = 0.0;
  EXPECT_THROW(ScalarSensor(description, "supply", {}), std::invalid_argument);
}

}  // namespace
}  // namespace koboshi::sim_board
