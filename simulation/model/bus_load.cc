#include "simulation/model/bus_load.h"

#include "hal/port/period.h"

namespace koboshi::simulation {
namespace {

constexpr double kBitsPerSecond = 1e6;
constexpr double kCycles_per_s = 1e6 / double{hal::kControlPeriod_us};
// Seven telemetry PDOs of the controller, all but the last of 8 bytes (docs/design/timing.md).
constexpr int kLongTelemetryPdos = 6;
constexpr int kShortTelemetryBytes = 7;
constexpr double kControllerHeartbeats_per_s = 50.0;
constexpr double kNodeHeartbeats_per_s = 10.0;
constexpr double kSupplyReadings_per_s = 4.0;  // of one drive in turn, by SDO
constexpr double kInertialSamples_per_s = 250.0;
constexpr int kSensorNodes = 3;

// ISO 11898-1: a frame with an 11-bit identifier and the intermission of 3 bits.
constexpr int shortest_bits(int bytes) { return 44 + 8 * bytes + 3; }
// All bits from SOF to the CRC sequence, 34 + 8 n, are stuffed; after the first five equal bits every fourth
// bit can be a stuff bit.
constexpr int most_stuff_bits(int bytes) { return (34 + 8 * bytes - 1) / 4; }

}  // namespace

std::vector<BusTraffic> bus_traffic(std::size_t drives, bool sensors_on_bus) {
  const auto count = static_cast<double>(drives);
  std::vector<BusTraffic> traffic{
      {"SYNC", 0, kCycles_per_s},
      {"targets of the drives", 6, count * kCycles_per_s},
      {"answers of the drives", 8, count * kCycles_per_s},
      {"telemetry", 8, kLongTelemetryPdos * kCycles_per_s},
      {"telemetry, last PDO", kShortTelemetryBytes, kCycles_per_s},
      {"heartbeats", 1, kControllerHeartbeats_per_s + count * kNodeHeartbeats_per_s},
      {"supply readings", 8, 2 * kSupplyReadings_per_s},
  };
  if (sensors_on_bus) {
    traffic.push_back({"inertial unit", 8, 2 * kInertialSamples_per_s});
    traffic.push_back({"ankle sensors", 8, 4 * kCycles_per_s});
    traffic.push_back({"heartbeats of sensors", 1, kSensorNodes * kNodeHeartbeats_per_s});
  }
  return traffic;
}

BusLoad bus_load(std::size_t drives, bool sensors_on_bus) {
  BusLoad load;
  for (const BusTraffic& each : bus_traffic(drives, sensors_on_bus)) {
    const int bits = shortest_bits(each.bytes);
    load.shortest += each.frames_per_s * bits / kBitsPerSecond;
    load.longest += each.frames_per_s * (bits + most_stuff_bits(each.bytes)) / kBitsPerSecond;
    load.frames_per_s += each.frames_per_s;
  }
  return load;
}

}  // namespace koboshi::simulation
