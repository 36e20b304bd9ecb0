// Restores snapshots of whole simulations: firmware, bus, drives, sensors, world, scenario and observers.

#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <vector>

#include "sim_board/can/transport/transport_node.h"
#include "sim_board/engine/make_world.h"
#include "sim_board/random/random_stream.h"
#include "simulation/observe/watched_simulation.h"
#include "simulation/scenario/reader.h"
#include "tests/closed_loop/run.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::test {
namespace {

using simulation::Simulation;
using simulation::Snapshot;

// A simulation with an observer and a PC that sends frames at fixed times: it stores parameters, then begins
// a block upload of a motion and abandons it.
class Watched {
 public:
  explicit Watched(const simulation::Scenario& scenario)
      : simulation_(scenario), recorder_(simulation_, nullptr) {}

  // Records the state hash after each millisecond, to compare two runs.
  void run_until_ms(std::uint64_t end_ms) {
    while (now_ms() < end_ms) {
      say();
      simulation_.advance();
      recorder_.record();
      hashes_[now_ms()] = recorder_.state_hash();
    }
  }
  std::uint64_t now_ms() const { return simulation_.board().now_us() / 1000; }
  std::vector<std::uint64_t> hashes(std::uint64_t after_ms, std::uint64_t for_ms) const {
    std::vector<std::uint64_t> hashes;
    for (std::uint64_t i = 1; i <= for_ms; ++i) hashes.push_back(hashes_.at(after_ms + i));
    return hashes;
  }
  std::string summary() const { return simulation::to_json(recorder_.summary()).dump(); }
  Simulation& simulation() { return simulation_; }
  simulation::RunRecorder& recorder() { return recorder_; }

 private:
  void say() {
    const auto request = [&](std::uint64_t at_ms, const std::array<std::uint8_t, 8>& data) {
      if (now_ms() == at_ms)
        static_cast<void>(simulation_.board().electronics().send_as_operator(
            {.identifier = static_cast<std::uint16_t>(canopen::kSdoRequestBase + kController),
             .size = 8,
             .data = data}));
    };
    request(610, {0x23, 0x10, 0x10, 0x01, 's', 'a', 'v', 'e'});
    request(1500, {0xA4, 0x00, 0x24, 0x01, 127, 0, 0, 0});
    request(1503, {0xA3, 0, 0, 0, 0, 0, 0, 0});
  }

  Simulation simulation_;
  simulation::RunRecorder recorder_;
  std::map<std::uint64_t, std::uint64_t> hashes_;
};

// The robot on its stand, released while it squats, with faults and disturbances drawn from the seed.
simulation::Scenario adventure(sim_board::Stepper stepper, std::uint64_t seed) {
  sim_board::RandomStream random(seed, "adventure");
  simulation::Scenario scenario = quick_squat();
  scenario.seed = seed;
  scenario.physics.stepper = stepper;
  const auto some_us = [&](std::uint64_t from_ms, std::uint64_t to_ms) {
    return 1000 * (from_ms + random.bits() % (to_ms - from_ms));
  };
  const auto fault = [&](simulation::Fault::Kind kind, const char* target = "") -> simulation::Fault& {
    simulation::Fault fault;
    fault.kind = kind;
    fault.target.text = target;
    fault.at_us = some_us(750, 1900);
    fault.duration_us = some_us(20, 300);
    scenario.faults.push_back(fault);
    return scenario.faults.back();
  };
  using Kind = simulation::Fault::Kind;
  fault(Kind::kFramesCorrupted).frames = {.effect = sim_board::FrameFault::Effect::kCorrupted, .share = 0.05};
  fault(Kind::kFramesDelayed).frames = {
      .effect = sim_board::FrameFault::Effect::kDelayed, .share = 0.1, .delay_us = 900};
  fault(Kind::kFramesLost, "left_knee").frames = {.effect = sim_board::FrameFault::Effect::kLost,
                                                  .share = 0.1};
  fault(Kind::kFramesDoubled).frames = {.effect = sim_board::FrameFault::Effect::kDoubled, .share = 0.1};
  fault(Kind::kBabblingNode).babble = {.frame = {.identifier = 0x010}, .interval_us = 1300};
  fault(Kind::kAnkleStop);
  fault(Kind::kSupplyDrop).highest_V = 6.5;
  fault(Kind::kDrivePowerLoss, "head_pan");
  simulation::Fault& discharge = fault(Kind::kBatteryDischarge);
  discharge.open_circuit_V = 6.8;
  discharge.over_us = 500'000;
  discharge.duration_us.reset();
  for (int i = 0; i < 3; ++i) {
    simulation::Push push;
    push.at_us = some_us(300, 2000);
    push.duration_us = some_us(5, 60);
    push.link.text = "trunk";
    push.force_W_N = {random.within(8.0), random.within(8.0), 0.0};
    scenario.pushes.push_back(push);
  }
  return scenario;
}

// Applies operator commands and disturbances for some time, so that the state differs from the snapshot.
void spoil(Watched& watched) {
  Simulation& simulation = watched.simulation();
  sim_board::SimBoard& board = simulation.board();
  simulation.command({.kind = simulation::Command::Kind::kEmergencyStop});
  simulation.write({{"ankle_pitch_gain_s", {}, 0}, 0.01});
  simulation::Push push;
  push.duration_us = 10'000;
  push.link.text = "trunk";
  push.force_W_N = {1.0, 2.0, 3.0};
  simulation.push(push);
  board.electronics().add_frame_fault({.effect = sim_board::FrameFault::Effect::kCorrupted, .share = 0.2});
  watched.run_until_ms(watched.now_ms() + 15);
  board.electronics().hang_drive(1);
  board.electronics().cut_drive_power(2);
  board.electronics().break_encoder(3);
  board.electronics().overheat_drive(4);
  board.electronics().limit_supply(5.0);
  board.electronics().set_imu_running(false);
  board.electronics().set_ankle_running(hal::Side::kRight, false);
  watched.run_until_ms(watched.now_ms() + 5);
  board.electronics().isolate_controller();
  board.electronics().bus().set_dominant(true);
  watched.run_until_ms(watched.now_ms() + 3);
}

class SnapshotInEachStepper : public testing::TestWithParam<sim_board::Stepper> {};

TEST_P(SnapshotInEachStepper, ContinuesWithTheSameBitsFromAnyTime) {
  if (GetParam() == sim_board::Stepper::kMujoco && !sim_board::has_mujoco())
    GTEST_SKIP() << "built without MuJoCo";
  constexpr std::uint64_t kEnd_ms = 2100;
  const simulation::Scenario scenario = adventure(GetParam(), 7);
  Watched whole(scenario);
  whole.run_until_ms(kEnd_ms);

  Watched parts(scenario);
  std::map<std::uint64_t, Snapshot> snapshots;
  // Snapshot times: before the first step; while drives boot; while parameters are stored; during a block
  // transfer and in fault; after the release.
  for (const std::uint64_t at_ms : {0u, 57u, 613u, 1507u, 1733u}) {
    parts.run_until_ms(at_ms);
    snapshots.emplace(at_ms, parts.simulation().snapshot());
  }
  parts.run_until_ms(kEnd_ms);
  EXPECT_EQ(parts.hashes(0, kEnd_ms), whole.hashes(0, kEnd_ms)) << "to take a snapshot changes the run";
  EXPECT_EQ(parts.summary(), whole.summary());

  for (const auto& [at_ms, for_ms] :
       {std::pair{1507u, 593u}, {57u, 130u}, {1733u, 150u}, {613u, 150u}, {0u, 60u}}) {
    spoil(parts);
    parts.simulation().restore(snapshots.at(at_ms));
    EXPECT_EQ(parts.now_ms(), at_ms);
    parts.run_until_ms(at_ms + for_ms);
    ASSERT_EQ(parts.hashes(at_ms, for_ms), whole.hashes(at_ms, for_ms)) << "from " << at_ms << " ms on";
    if (at_ms + for_ms == kEnd_ms) {
      EXPECT_EQ(parts.summary(), whole.summary());
    }
  }
}

// Returns the memory image of board and drives without the measured wall time. A member that no archive
// function lists would keep its value from the run in between, and the images would differ.
std::vector<std::byte> image(const sim_board::SimBoard& board) {
  std::vector<std::byte> image;
  const auto add = [&](const auto& object) {
    const auto bytes = std::as_bytes(std::span(&object, 1));
    image.insert(image.end(), bytes.begin(), bytes.end());
  };
  add(board);
  const std::ptrdiff_t shares =
      reinterpret_cast<const std::byte*>(&board.time_shares()) - reinterpret_cast<const std::byte*>(&board);
  std::fill_n(image.begin() + shares, sizeof(sim_board::TimeShares), std::byte{0});
  for (std::size_t joint = 0; joint < board.electronics().robot().joints.size(); ++joint)
    add(board.electronics().drive(joint));
  return image;
}

TEST(Snapshot, ReplacesTheStateCompletely) {
  Watched watched(adventure(sim_board::Stepper::kLumped, 3));
  Simulation& simulation = watched.simulation();
  watched.run_until_ms(300);
  const Snapshot early = simulation.snapshot();
  watched.run_until_ms(1650);
  const Snapshot late = simulation.snapshot();
  watched.run_until_ms(1950);
  for (const Snapshot* snapshot : {&early, &late}) {
    simulation.restore(*snapshot);
    const std::vector<std::byte> before = image(simulation.board());
    spoil(watched);
    simulation.restore(snapshot == &early ? late : early);
    watched.run_until_ms(watched.now_ms() + 33);
    simulation.restore(*snapshot);
    const std::vector<std::byte> after = image(simulation.board());
    const auto other = std::ranges::mismatch(before, after).in1 - before.begin();
    EXPECT_EQ(before, after) << "the first byte that is another: " << other << ", where the board has "
                             << sizeof(sim_board::SimBoard) << " and each drive " << sizeof(sim_board::Drive);
  }
}

TEST(Snapshot, BelongsToOneSimulationAndItsObservers) {
  const simulation::Scenario scenario = hanging_squat();
  Simulation simulation(scenario), other(scenario);
  const Snapshot snapshot = simulation.snapshot();
  EXPECT_THROW(other.restore(snapshot), std::logic_error);
  {
    const simulation::RunRecorder recorder(simulation, nullptr);
    EXPECT_THROW(simulation.restore(snapshot), std::logic_error);
  }
  simulation.restore(snapshot);
  EXPECT_EQ(snapshot.time_us(), 0u);
}

TEST(Snapshot, IsRejectedWithExternalProcesses) {
  Simulation simulation(hanging_squat());
  {
    const TemporaryFolder folder;
    simulation::Recorder files(folder.path, simulation::RunRecorder::columns(simulation.robot()),
                               simulation::WhenFull::kWait);
    const simulation::RunRecorder recorder(simulation, &files);
    EXPECT_THROW(static_cast<void>(simulation.snapshot()), sim_board::NotSaveable);
  }
  static_cast<void>(simulation.snapshot());
  class : public sim_board::Transport {
    bool send(const hal::CanFrame&, std::uint64_t) override { return true; }
    std::optional<hal::CanFrame> receive() override { return std::nullopt; }
    std::string place() const override { return "nowhere"; }
  } outside;
  const sim_board::TransportNode bridge(simulation.board().electronics().bus(), outside);
  EXPECT_THROW(static_cast<void>(simulation.snapshot()), sim_board::NotSaveable);
}

// Checks the size in the comment of Snapshot, and prints the cost of a snapshot.
TEST(Snapshot, IsSmall) {
  Watched watched(quick_squat());
  watched.run_until_ms(1700);
  const std::size_t before_bytes = mallinfo2().uordblks;
  const Snapshot kept = watched.simulation().snapshot();
  const std::size_t heap_bytes = mallinfo2().uordblks - before_bytes;
  EXPECT_LT(heap_bytes, 400u << 10);
  EXPECT_NEAR(static_cast<double>(kept.size_bytes()), 160.0 * 1024.0, 40.0 * 1024.0);

  std::vector<double> times_us;
  for (int i = 0; i < 50; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const Snapshot snapshot = watched.simulation().snapshot();
    watched.simulation().restore(snapshot);
    const std::chrono::duration<double, std::micro> duration = std::chrono::steady_clock::now() - start;
    times_us.push_back(duration.count());
  }
  std::ranges::sort(times_us);
  std::printf("a snapshot: %zu KiB on the heap, %zu KiB of it plain bytes; taken and restored in %.0f us\n",
              heap_bytes >> 10, kept.size_bytes() >> 10, times_us.front());
}

TEST_P(SnapshotInEachStepper, ResetEqualsANewSimulation) {
  if (GetParam() == sim_board::Stepper::kMujoco && !sim_board::has_mujoco())
    GTEST_SKIP() << "built without MuJoCo";
  constexpr std::size_t kDuration_ms = 150;
  simulation::Scenario scenario = adventure(GetParam(), 1);
  simulation::WatchedSimulation used(scenario);
  used.step(90);
  const Snapshot snapshot = used.snapshot();
  used.simulation().push(scenario.pushes.front());
  used.step(60);
  const auto start = std::chrono::steady_clock::now();
  used.reset(9);
  const auto anew = std::chrono::steady_clock::now();
  EXPECT_THROW(used.restore(snapshot), std::logic_error);
  used.step(kDuration_ms);

  scenario.seed = 9;
  const auto made = std::chrono::steady_clock::now();
  simulation::WatchedSimulation fresh(scenario);
  const auto done = std::chrono::steady_clock::now();
  std::printf("a reset: %.1f ms; another simulation: %.1f ms\n",
              std::chrono::duration<double, std::milli>(anew - start).count(),
              std::chrono::duration<double, std::milli>(done - made).count());
  fresh.step(kDuration_ms);
  EXPECT_EQ(used.recorder().state_hash(), fresh.recorder().state_hash());
  EXPECT_EQ(simulation::to_json(used.recorder().summary()), simulation::to_json(fresh.recorder().summary()));
}

TEST(Reset, IsRefusedWhileObserversAreAttached) {
  Simulation simulation(hanging_squat());
  const simulation::RunRecorder recorder(simulation, nullptr);
  EXPECT_THROW(simulation.reset(2), std::logic_error);
}

INSTANTIATE_TEST_SUITE_P(, SnapshotInEachStepper,
                         testing::Values(sim_board::Stepper::kWorld, sim_board::Stepper::kLumped,
                                         sim_board::Stepper::kMujoco),
                         [](const auto& info) { return std::string(sim_board::name_of(info.param)); });

}  // namespace
}  // namespace koboshi::test
