#include "simulation/model/bus_load.h"

#include "firmware/app/dictionary.h"
#include "hal/port/period.h"

namespace koboshi::simulation {
namespace {

constexpr double kBitsPerSecond = 1e6;
constexpr double kCycles_per_s = 1e6 / double{hal::kControlPeriod_us};
// Telemetry of the controller (docs/design/timing.md): PDOs in each cycle, and two in every tenth, of which
// one has 7 bytes.
constexpr int kPlaceBytes = 7;
constexpr double kSlowTelemetry_per_s = 10.0;
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

BusLoad load_of(const std::vector<BusTraffic>& traffic) {
  BusLoad load;
  for (const BusTraffic& each : traffic) {
    const int bits = shortest_bits(each.bytes);
    load.shortest += each.frames_per_s * bits / kBitsPerSecond;
    load.longest += each.frames_per_s * (bits + most_stuff_bits(each.bytes)) / kBitsPerSecond;
    load.frames_per_s += each.frames_per_s;
  }
  return load;
}

}  // namespace

std::vector<BusTraffic> bus_traffic(std::size_t drives, bool sensors_on_bus) {
  const auto count = static_cast<double>(drives);
  const bool has_all = drives <= app::kMaxJointsWithAllTpdos;
  const double telemetry_pdos = has_all ? app::kTpdosOfALargeRobot + 1 : app::kTpdosOfALargeRobot;
  std::vector<BusTraffic> traffic{
      {"SYNC", 0, kCycles_per_s},
      {"targets of the drives", 6, count * kCycles_per_s},
      {"answers of the drives", 8, count * kCycles_per_s},
      {"telemetry", 8, telemetry_pdos * kCycles_per_s},
      {"heartbeats", 1, kControllerHeartbeats_per_s + count * kNodeHeartbeats_per_s},
      {"supply readings", 8, 2 * kSupplyReadings_per_s},
  };
  if (has_all) {
    traffic.push_back({"telemetry of the place", kPlaceBytes, kSlowTelemetry_per_s});
    traffic.push_back({"telemetry of the ground", 8, kSlowTelemetry_per_s});
  }
  if (sensors_on_bus) {
    traffic.push_back({"inertial unit", 8, 2 * kInertialSamples_per_s});
    traffic.push_back({"ankle sensors", 8, 4 * kCycles_per_s});
    traffic.push_back({"heartbeats of sensors", 1, kSensorNodes * kNodeHeartbeats_per_s});
  }
  return traffic;
}

BusLoad bus_load(std::size_t drives, bool sensors_on_bus) {
  return load_of(bus_traffic(drives, sensors_on_bus));
}

BusLoad stream_load(std::size_t drives, double sets_per_s) {
  constexpr std::size_t kTargetsPerFrame = 4;
  const auto full = static_cast<double>(drives / kTargetsPerFrame);
  const auto rest = static_cast<int>(drives % kTargetsPerFrame);
  std::vector<BusTraffic> traffic{{"streamed targets", 8, full * sets_per_s},
                                  {"sequence counter of the stream", 1, sets_per_s}};
  if (rest > 0) traffic.push_back({"last streamed targets", 2 * rest, sets_per_s});
  return load_of(traffic);
}

double max_stream_rate_Hz(std::size_t drives, bool sensors_on_bus) {
  constexpr int kSlowest = 10;  // cycles, the controller's deadline
  const double own = bus_load(drives, sensors_on_bus).longest;
  for (int cycles = 1; cycles <= kSlowest; ++cycles) {
    const double rate_Hz = kCycles_per_s / cycles;
    if (own + stream_load(drives, rate_Hz).longest <= kMaxBusLoad) return rate_Hz;
  }
  return 0.0;
}

}  // namespace koboshi::simulation
