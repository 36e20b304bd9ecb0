#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace koboshi::simulation {

// One kind of frame that the bus of a robot carries all the time.
struct BusTraffic {
  std::string_view name;
  int bytes = 0;
  double frames_per_s = 0.0;  // of all senders together
};

// The load of the bus at 1 Mbit/s, 0..1, with no and with all possible stuff bits, intermissions included.
// Real frames lie between.
struct BusLoad {
  double shortest = 0.0;
  double longest = 0.0;
  double frames_per_s = 0.0;
};

// Limit of BusLoad::longest. The rest is for SDO transfers, emergencies and repeated frames.
inline constexpr double kMaxBusLoad = 0.9;

// Returns the frames of a running robot with this number of drives. `sensors_on_bus`: the IMU and the ankle
// sensors are nodes of the bus (`koboshi board`).
[[nodiscard]] std::vector<BusTraffic> bus_traffic(std::size_t drives, bool sensors_on_bus);
[[nodiscard]] BusLoad bus_load(std::size_t drives, bool sensors_on_bus);
// Returns what a joint target stream of `sets_per_s` adds: targets of all joints and the sequence counter,
// without torque limits.
[[nodiscard]] BusLoad stream_load(std::size_t drives, double sets_per_s);
// Returns the highest rate of sets, in Hz, of one in each control cycle, in every second, third ... tenth
// cycle, with which the bus stays within kMaxBusLoad; 0 if none does.
[[nodiscard]] double max_stream_rate_Hz(std::size_t drives, bool sensors_on_bus);

}  // namespace koboshi::simulation
