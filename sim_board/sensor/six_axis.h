#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>

#include "sim_board/robot/description.h"
#include "sim_board/sensor/channel.h"
#include "sim_board/sensor/delay.h"
#include "sim_board/sensor/sampler.h"

namespace koboshi::sim {

// Two channels that share one clock and one delay: what an inertial unit and a six-axis force sensor have in
// common.
class SixAxis {
 public:
  struct Sample {
    std::uint64_t time_us = 0;  // nominal sampling instant: a sensor does not know its jitter
    std::array<std::int16_t, 3> first_raw{};
    std::array<std::int16_t, 3> second_raw{};
  };

  // The names tell the random streams of the two channels and of their clock apart. Throws
  // std::invalid_argument for what Channel refuses, and where sampling period, jitter or delay of the two
  // differ. These are rounded to whole microseconds; jitter that errors.scale takes to half a sampling period
  // is cut to less.
  SixAxis(const ChannelDescription& first, const ChannelDescription& second, std::string_view first_name,
          std::string_view second_name, std::string_view name, const SensorErrors& errors);

  // What the two measure at `time_us`, and on a straight line since the last call. Takes the samples that
  // fall due. The first call settles the filters and takes none. Times increase.
  void step(const Eigen::Vector3d& first, const Eigen::Vector3d& second, std::uint64_t time_us);
  // Takes the oldest sample that has arrived by `now_us`, in order. False, and `sample` untouched, when there
  // is none.
  [[nodiscard]] bool poll(std::uint64_t now_us, Sample& sample);
  // A stopped sensor delivers nothing, not even what was under way.
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

}  // namespace koboshi::sim
