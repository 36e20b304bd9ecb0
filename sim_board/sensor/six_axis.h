#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>

#include "sim_board/description/description.h"
#include "sim_board/sensor/channel.h"
#include "sim_board/sensor/sampler.h"

namespace koboshi::sim_board {

// Two triads with a common clock and delay. An inertial unit (gyro, accelerometer) and a six-axis force
// sensor (force, torque) each have one.
class SixAxis {
 public:
  struct Sample {
    std::uint64_t time_us = 0;  // nominal sampling instant: the sensor does not know its jitter
    std::array<std::int16_t, 3> first_raw{};
    std::array<std::int16_t, 3> second_raw{};
  };

  // `first_name`, `second_name` and `name` identify the random streams of the two channels and of the clock.
  // Period, jitter and delay are rounded to whole microseconds; jitter scaled by errors.scale is limited to
  // Sampler::max_jitter_us(). Throws std::invalid_argument as Channel does, and if period, jitter or delay of
  // the two channels differ.
  SixAxis(const ChannelDescription& first, const ChannelDescription& second, std::string_view first_name,
          std::string_view second_name, std::string_view name, const SensorErrors& errors);

  // Sets the two quantities at `time_us` and takes the samples that have become due, with linear
  // interpolation since the previous call. The first call settles the filters and takes no sample. Times must
  // increase.
  void step(const Eigen::Vector3d& first, const Eigen::Vector3d& second, std::uint64_t time_us);
  // Takes the oldest sample that has arrived by `now_us`. Returns false and leaves `sample` unchanged if
  // there is none.
  [[nodiscard]] bool poll(std::uint64_t now_us, Sample& sample);
  // A stopped sensor delivers no samples, including those in transit.
  void set_running(bool running);

 private:
  void advance(const Eigen::Vector3d& first, const Eigen::Vector3d& second, std::uint64_t time_us);

  Channel first_;
  Channel second_;
  Sampler sampler_;
  Delay<Sample> delay_;
  std::uint64_t time_us_ = 0;
  bool started_ = false;
  bool running_ = true;
};

}  // namespace koboshi::sim_board
