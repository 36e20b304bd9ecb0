#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/canopen/described_object.h"
#include "hal/port/can.h"
#include "sim_board/description/description.h"

namespace koboshi::bus {

// A value in the data of a frame: little-endian, `raw * factor` of its unit.
struct Signal {
  std::string name;
  unsigned start_bit = 0;
  unsigned size_bits = 0;
  bool is_signed = false;
  double factor = 1.0;
  std::int64_t low_raw = 0;
  std::int64_t high_raw = 0;
  std::string unit = {};
  std::span<const canopen::ValueName> values = {};
  std::string comment = {};
  std::vector<std::string> receivers = {};
};

struct Message {
  std::uint16_t identifier = 0;
  std::string name;
  unsigned size_bytes = 0;
  std::string sender;
  std::uint32_t cycle_time_ms = 0;  // 0: event-driven
  std::string comment;
  std::vector<Signal> signals;
};

struct NetworkNode {
  std::uint8_t node_id = 0;  // 0: no CANopen node
  std::string name;
};

// All messages on a robot's bus in operation.
struct Network {
  std::vector<NetworkNode> nodes;
  std::vector<Message> messages;  // by identifier, ascending

  // Null if there is none.
  const Message* find(std::uint16_t identifier) const;
};

// The CANopen nodes of a robot: the controller, its drives by the names of their joints, its sensors.
std::vector<NetworkNode> network_nodes(const sim_board::RobotDescription& robot);

// The network of a robot: the controller, its drives by the names of their joints, its sensors. The drives'
// PDOs are those that the firmware configures. Throws InputError for a robot that the firmware cannot
// express.
Network make_network(const sim_board::RobotDescription& robot);

// A decoded signal of a received frame.
struct Reading {
  const Signal* signal = nullptr;
  std::int64_t raw = 0;
  double value = 0.0;          // of signal->unit
  std::string_view name = {};  // name of the raw value, or empty
};

// Decodes the signals of a frame, in the order of its bytes, without those beyond the end of a short frame.
// Empty if the network has no such message. The network must outlive the readings.
std::vector<Reading> decode(const Network& network, const hal::CanFrame& frame);

}  // namespace koboshi::bus
