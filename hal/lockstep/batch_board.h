#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/lockstep/batch.h"
#include "hal/port/board.h"
#include "hal/port/fifo.h"

namespace koboshi::hal {

// A board that exchanges messages instead of driving peripherals: between `begin` and `end` its ports serve
// the firmware from one BatchInput and collect one BatchOutput. Both the simulated board and the Cortex-M4
// image use it.
//
// As on hardware, unread data stay available in the next call: frames and IMU samples in queues with the
// capacity of a BatchInput (the excess is lost and counted as overrun), and the latest sample of each ankle.
// Storage is not part of the messages: each board has its own.
class BatchBoard final : private CanPort,
                         private ImuPort,
                         private AnklePort,
                         private WatchdogPort,
                         private DriveEnablePort {
 public:
  // `sensor_nodes` as in Board. Both arguments must outlive this object.
  explicit BatchBoard(StoragePort& storage, std::span<const std::uint8_t> sensor_nodes = {})
      : storage_(storage), sensor_nodes_(sensor_nodes) {}
  BatchBoard(const BatchBoard&) = delete;
  BatchBoard& operator=(const BatchBoard&) = delete;

  // Returns the ports, valid during the lifetime of this object.
  [[nodiscard]] Board board() { return {*this, *this, *this, storage_, *this, *this, sensor_nodes_}; }
  // Starts a call: copies the input and clears the output except the level of the drive-enable line, which is
  // initially low and then keeps its value.
  void begin(const BatchInput& input);
  // Ends the call and returns its output, valid until the next `begin`.
  [[nodiscard]] const BatchOutput& end() const { return output_; }

 private:
  bool receive(CanFrame& frame) override { return frames_.pop(frame); }
  bool transmit(const CanFrame& frame) override;
  std::size_t transmit_space(TransmitFifo fifo) const override;
  bool transmit_pending(TransmitFifo fifo) const override { return transmit_pending_[fifo]; }
  CanStatus status() const override { return status_; }
  void recover() override;
  bool read(ImuSample& sample) override { return imu_.pop(sample); }
  std::uint16_t overruns() const override { return imu_overruns_; }
  bool read(Side side, AnkleSample& sample) override;
  void kick(std::uint64_t) override { output_.watchdog_kicked = true; }
  void set(bool enabled) override { output_.drive_enabled = enabled; }

  StoragePort& storage_;
  std::span<const std::uint8_t> sensor_nodes_;
  Fifo<CanFrame, BatchInput::kMaxFrames> frames_;
  Fifo<ImuSample, BatchInput::kMaxImuSamples> imu_;
  std::uint16_t frames_lost_ = 0;  // overruns here, in addition to those of the board
  std::uint16_t samples_lost_ = 0;
  CanStatus status_;
  std::uint16_t imu_overruns_ = 0;
  std::array<std::uint16_t, kTransmitFifos> transmit_space_{};  // by TransmitFifo; room left in this call
  std::array<bool, kTransmitFifos> transmit_pending_{};
  std::array<bool, 2> ankle_fresh_{};
  std::array<AnkleSample, 2> ankles_{};
  BatchOutput output_;
};

}  // namespace koboshi::hal
