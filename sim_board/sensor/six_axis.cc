#include "sim_board/sensor/six_axis.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace koboshi::sim_board {
namespace {

// Capacity of the FIFO in addition to the samples in transit, for a board that polls less often than the
// sensor samples.
constexpr std::size_t kFifoSamples = 64;

std::uint64_t to_us(double time_s) {
  if (!(time_s >= 0.0)) throw std::invalid_argument("sensor: period, jitter and delay must not be negative");
  return static_cast<std::uint64_t>(std::llround(time_s * 1e6));
}

std::uint64_t shared_us(double first_s, double second_s) {
  if (to_us(first_s) != to_us(second_s)) {
    throw std::invalid_argument("sensor: both channels must have the same period, jitter and delay");
  }
  return to_us(first_s);
}

std::size_t fifo_capacity(const ChannelDescription& channel) {
  return kFifoSamples + static_cast<std::size_t>(channel.delay_s / channel.sample_period_s);
}

// The clock that both channels share.
Sampler make_sampler(const ChannelDescription& first, const ChannelDescription& second, std::string_view name,
                     const SensorErrors& errors) {
  const std::uint64_t period_us = shared_us(first.sample_period_s, second.sample_period_s);
  const std::uint64_t jitter_us = shared_us(first.jitter_s * errors.scale, second.jitter_s * errors.scale);
  return {
      period_us,
      {std::min(jitter_us, Sampler::max_jitter_us(period_us)), errors.seed, std::string(name) + ".jitter"}};
}

}  // namespace

SixAxis::SixAxis(const ChannelDescription& first, const ChannelDescription& second,
                 std::string_view first_name, std::string_view second_name, std::string_view name,
                 const SensorErrors& errors)
    : first_(first, first_name, errors),
      second_(second, second_name, errors),
      sampler_(make_sampler(first, second, name, errors)),
      delay_(shared_us(first.delay_s, second.delay_s), fifo_capacity(first)) {}

void SixAxis::step(const Eigen::Vector3d& first, const Eigen::Vector3d& second, std::uint64_t time_us) {
  if (!started_) {
    first_.filter().settle(first);
    second_.filter().settle(second);
    sampler_.start(time_us);
    time_us_ = time_us;
    started_ = true;
    return;
  }
  const Eigen::Vector3d first_start = first_.filter().input();
  const Eigen::Vector3d second_start = second_.filter().input();
  const std::uint64_t start_us = time_us_;
  while (sampler_.due(time_us)) {
    const Sampler::Instant instant = sampler_.take();
    const double part =
        static_cast<double>(instant.actual_us - start_us) / static_cast<double>(time_us - start_us);
    advance(first_start + part * (first - first_start), second_start + part * (second - second_start),
            instant.actual_us);
    const Sample sample{instant.nominal_us, first_.sample(), second_.sample()};
    if (running_) delay_.push(sample, instant.nominal_us);
  }
  advance(first, second, time_us);
}

void SixAxis::advance(const Eigen::Vector3d& first, const Eigen::Vector3d& second, std::uint64_t time_us) {
  if (time_us == time_us_) return;
  first_.filter().advance(first, time_us - time_us_);
  second_.filter().advance(second, time_us - time_us_);
  time_us_ = time_us;
}

bool SixAxis::poll(std::uint64_t now_us, Sample& sample) { return delay_.poll(now_us, sample); }

void SixAxis::set_running(bool running) {
  if (!running) delay_.clear();
  running_ = running;
}

}  // namespace koboshi::sim_board
