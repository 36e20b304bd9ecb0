#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>

#include "hal/port/ankle.h"
#include "hal/port/fifo.h"
#include "hal/port/imu.h"

namespace koboshi::hal {

// An inertial unit whose samples the test delivers.
class FakeImu final : public ImuPort {
 public:
  static constexpr std::size_t kCapacity = 16;

  // Delivers a sample. If the FIFO is full, it is lost and counted.
  void deliver(const ImuSample& sample) {
    if (samples_.push(sample)) return;
    if (overruns_ < std::numeric_limits<std::uint16_t>::max()) ++overruns_;
  }

  [[nodiscard]] bool read(ImuSample& sample) override { return samples_.pop(sample); }
  [[nodiscard]] std::uint16_t overruns() const override { return overruns_; }

 private:
  Fifo<ImuSample, kCapacity> samples_;
  std::uint16_t overruns_ = 0;
};

// Two ankle sensors; each keeps the latest sample that the test has delivered.
class FakeAnkles final : public AnklePort {
 public:
  void deliver(Side side, const AnkleSample& sample) { latest(side) = sample; }

  [[nodiscard]] bool read(Side side, AnkleSample& sample) override {
    if (!latest(side)) return false;
    sample = *latest(side);
    latest(side).reset();
    return true;
  }

 private:
  std::optional<AnkleSample>& latest(Side side) { return latest_[static_cast<std::size_t>(side)]; }

  std::array<std::optional<AnkleSample>, 2> latest_;
};

}  // namespace koboshi::hal
