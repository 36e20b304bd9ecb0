#pragma once

#include <cstdint>

#include "firmware/canopen/node/device_services.h"
#include "firmware/canopen/node/node.h"
#include "hal/port/ankle.h"
#include "hal/port/imu.h"
#include "sim_board/can/bus.h"
#include "sim_board/can/bus_off_pause.h"
#include "sim_board/can/canopen_filter.h"
#include "sim_board/description/reserved_nodes.h"
#include "sim_board/sensor/sensor_dictionary.h"
#include "sim_board/storage/node_storage.h"

namespace koboshi::sim_board {

// Sensor as a CANopen node. Sends its latest sample: an inertial unit periodically, an ankle sensor at each
// SYNC.
class SensorNode final : private BusNode,
                         private canopen::FrameSink,
                         private canopen::NodeApplication,
                         private canopen::DeviceOwner {
 public:
  static constexpr std::uint64_t kBootTime_us = 50'000;  // from power-on to the boot-up message
  static constexpr std::size_t kTransmitFifo = 8;

  // Attaches the node to the bus and powers it. The bus must outlive it.
  SensorNode(SensorKind kind, std::uint8_t node_id, Bus& bus);
  SensorNode(const SensorNode&) = delete;
  SensorNode& operator=(const SensorNode&) = delete;

  // Sets the latest sample.
  void take(const hal::ImuSample& sample) {
    store(sample.gyro_raw, values_.gyro, sample.accelerometer_raw, values_.accelerometer);
  }
  void take(const hal::AnkleSample& sample);
  // Call it once per millisecond: processes timers, storage and bus-off recovery.
  void update(std::uint64_t now_us);

  NodeHandle bus_handle() const { return handle_; }

  void archive(StateArchive& archive);

 private:
  using Axes = std::array<std::int16_t, 3>;

  void store(const Axes& first, std::int16_t (&first_values)[3], const Axes& second,
             std::int16_t (&second_values)[3]);
  void on_frame(const hal::CanFrame& frame, std::uint64_t time_us) override;
  canopen::AbortCode on_store(canopen::ParameterGroup group) override { return storage_.store(group); }
  canopen::AbortCode on_restore(canopen::ParameterGroup group) override { return storage_.restore(group); }
  canopen::AbortCode on_store_node_id(std::uint8_t node_id) override {
    return storage_.store_node_id(node_id);
  }
  void on_reset(canopen::NmtCommand reset) override { storage_.load(reset); }
  bool send(const hal::CanFrame& frame) override { return bus_.queue(handle_, frame, now_us_); }

  Bus& bus_;
  NodeHandle handle_;
  canopen::NodeDescription description_;
  SensorValues values_;
  canopen::NodeMemory<0, kSensorTpdos, 2, 8> memory_;
  canopen::DeviceServices services_;
  canopen::Node node_;
  NodeStorage storage_{node_};
  BusOffPause bus_off_;
  CanopenFilter filter_;
  bool started_ = false;
  std::uint64_t now_us_ = 0;
};

}  // namespace koboshi::sim_board
