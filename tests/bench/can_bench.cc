#include <benchmark/benchmark.h>

#include <array>
#include <filesystem>
#include <vector>

#include "sim_board/can/bus.h"
#include "sim_board/can/bus_faults.h"
#include "sim_board/can/candump_log.h"
#include "sim_board/can/frame_bits.h"
#include "simulation/record/recorder.h"

namespace koboshi::sim_board {
namespace {

constexpr std::size_t kDrives = 20;

hal::CanFrame telemetry(std::size_t drive, std::uint64_t cycle) {
  hal::CanFrame frame{.identifier = static_cast<std::uint16_t>(0x190 + drive),
                      .size = 8,
                      .remote = false,
                      .data = {0x37, 0x12}};
  for (std::size_t i = 2; i < frame.size; ++i)
    frame.data[i] = static_cast<std::uint8_t>(cycle >> (8 * (i - 2)));
  return frame;
}

class Counter final : public BusNode {
 public:
  void on_frame(const hal::CanFrame&, std::uint64_t) override { ++frames; }
  std::uint64_t frames = 0;
};

void BM_FrameBits(benchmark::State& state) {
  std::uint64_t cycle = 0;
  for (auto _ : state) benchmark::DoNotOptimize(frame_bits(telemetry(3, ++cycle)));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_FrameBits);

// A bus that never rests: twenty drives whose frames the controller takes, each arbitration among all of
// them.
void BM_SaturatedBus(benchmark::State& state) {
  Bus bus;
  Counter controller;
  std::vector<Counter> drives(kDrives);
  bus.attach(controller, AcceptanceFilter::all(), 64);
  std::vector<NodeHandle> handles;
  for (Counter& drive : drives) handles.push_back(bus.attach(drive, {0x080}, 4));
  std::uint64_t cycle = 0;
  for (auto _ : state) {
    ++cycle;
    const std::uint64_t now_us = bus.now_us();
    for (std::size_t i = 0; i < kDrives; ++i) {
      benchmark::DoNotOptimize(bus.queue(handles[i], telemetry(i, cycle), now_us));
    }
    bus.advance_to(now_us + 2700);  // more than twenty of the longest frames
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(controller.frames));
}
BENCHMARK(BM_SaturatedBus);

// The same, with every frame told to every node, as CANopen nodes want it, and a disturbance that is asked
// for each of them.
void BM_SaturatedBusOfListeners(benchmark::State& state) {
  Bus bus;
  BusFaults faults(1);
  faults.add({.effect = FrameFault::Effect::kLost, .first_identifier = 0x080, .last_identifier = 0x080});
  bus.set_disturbance(&faults);
  std::vector<Counter> nodes(1 + kDrives);
  std::vector<NodeHandle> handles;
  for (Counter& node : nodes) handles.push_back(bus.attach(node, AcceptanceFilter::all(), 4));
  std::uint64_t cycle = 0;
  for (auto _ : state) {
    ++cycle;
    const std::uint64_t now_us = bus.now_us();
    for (std::size_t i = 0; i < kDrives; ++i)
      benchmark::DoNotOptimize(bus.queue(handles[i + 1], telemetry(i, cycle), now_us));
    bus.advance_to(now_us + 2700);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(nodes.front().frames));
}
BENCHMARK(BM_SaturatedBusOfListeners);

void BM_FormatLogLine(benchmark::State& state) {
  std::array<char, kMaxLogLineBytes> line;
  std::uint64_t time_us = 0;
  for (auto _ : state) {
    time_us += 222;
    benchmark::DoNotOptimize(format_log_line(line, telemetry(5, time_us), time_us));
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_FormatLogLine);

// Cost of recording a 10 ms cycle of the walking robot in the simulating thread: 48 frames and a row of 200
// cells.
void BM_RecordCycle(benchmark::State& state) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "koboshi_can_bench";
  std::filesystem::create_directories(folder);
  {
    // Large enough for all cycles, so that the writer, who is slower than this loop, holds up nothing.
    simulation::Recorder recorder(folder, std::vector<simulation::TraceColumn>(200, {"x", "m"}),
                                  simulation::WhenFull::kDrop, std::size_t{1} << 20);
    const std::vector<simulation::TraceValue> row(200, simulation::TraceValue(0.1234567890123));
    std::uint64_t time_us = 0;
    for (auto _ : state) {
      for (std::size_t i = 0; i < 48; ++i)
        recorder.on_bus_frame(telemetry(i, time_us), time_us, time_us + 130);
      recorder.row(time_us += 10'000, row);
    }
    state.counters["dropped"] = static_cast<double>(recorder.dropped());
    recorder.close();
  }
  std::filesystem::remove_all(folder);
}
BENCHMARK(BM_RecordCycle)->Iterations(2000);

}  // namespace
}  // namespace koboshi::sim_board
