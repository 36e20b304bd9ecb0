#include "sim_board/sensor/six_axis.h"

#include <cmath>
#include <stdexcept>

namespace koboshi::sim {
namespace {

// Samples that a sensor keeps beyond those under way, for a board that polls less often than it samples.
constexpr std::size_t kFifoSamples = 64;

std::uint64_t to_us(double time_s) {
  if (!(time_s >= 0.0)) throw std::invalid_argument("sensor: sampling period and delay must not be negative");
  return static_cast<std::uint64_t>(std::llround(time_s * 1e6));
}

std::uint64_t shared_us(double first_s, double second_s) {
  if (to_us(first_s) != to_us(second_s)) {
    throw std::invalid_argument("sensor: both channels must have the same sampling period and delay");
  }
  return to_us(first_s);
}

std::size_t fifo_capacity(const ChannelDescription& channel) {
  return kFifoSamples + static_cast<std::size_t>(channel.delay_s / channel.sample_period_s);
}

}  // namespace

SixAxis::SixAxis(const ChannelDescription& first, const ChannelDescription& second,
                 std::string_view first_name, std::string_view second_name, const SensorErrors& errors)
    : first_(first, first_name, errors),
      second_(second, second_name, errors),
      sampler_(shared_us(first.sample_period_s, second.sample_period_s)),
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
    const std::uint64_t instant_us = sampler_.take();
    const double part = static_cast<double>(instant_us - start_us) / static_cast<double>(time_us - start_us);
    advance(first_start + part * (first - first_start), second_start + part * (second - second_start),
            instant_us);
    const Sample sample{instant_us, first_.sample(), second_.sample()};
    if (running_) delay_.push(sample, instant_us);
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

}  // namespace koboshi::sim
