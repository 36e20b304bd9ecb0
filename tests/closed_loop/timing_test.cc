#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <utility>

#include "simulation/model/bus_load.h"
#include "tests/closed_loop/run.h"

// Holds the simulation to docs/design/timing.md.
namespace koboshi::test {
namespace {

constexpr std::uint64_t kCycle_us = 10'000;
constexpr std::uint16_t kSync = 0x080;
constexpr std::uint16_t kFirstRpdo = 0x210;
constexpr std::uint16_t kFirstTpdo = 0x190;
constexpr std::array<std::uint16_t, 10> kTelemetry{0x181, 0x281, 0x381, 0x481, 0x182,
                                                   0x282, 0x382, 0x482, 0x202, 0x302};

bool is_within(const RobotRun::Frame& frame, std::uint16_t first_identifier) {
  return frame.frame.identifier >= first_identifier && frame.frame.identifier < first_identifier + 20;
}

// One second of squats, recorded cycle by cycle.
class Timing : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    run_ = std::make_unique<RobotRun>(hanging_squat());
    run_->run_until_us(kFirst_us);
    before_ = run_->board().electronics().bus().usage();
    run_->run_until_us(kLast_us);
    after_ = run_->board().electronics().bus().usage();
  }
  static void TearDownTestSuite() { run_.reset(); }

  // Returns the frames that began in the cycle after this tick.
  static std::vector<RobotRun::Frame> frames_of_cycle(std::uint64_t tick_us) {
    std::vector<RobotRun::Frame> frames;
    std::ranges::copy_if(run_->frames(), std::back_inserter(frames), [&](const RobotRun::Frame& frame) {
      return frame.start_us >= tick_us && frame.start_us < tick_us + kCycle_us;
    });
    return frames;
  }

  static constexpr std::uint64_t kFirst_us = 3'500'000;
  static constexpr std::uint64_t kLast_us = 4'500'000;
  static inline std::unique_ptr<RobotRun> run_;
  static inline sim_board::BusUsage before_;
  static inline sim_board::BusUsage after_;
};

TEST_F(Timing, EveryCycleIsTwentyRpdosThenSyncThenTwentyAnswers) {
  for (std::uint64_t tick_us = kFirst_us; tick_us < kLast_us; tick_us += kCycle_us) {
    std::vector<std::uint16_t> pdos;
    for (const RobotRun::Frame& frame : frames_of_cycle(tick_us)) {
      const bool counts =
          frame.frame.identifier == kSync || is_within(frame, kFirstRpdo) || is_within(frame, kFirstTpdo);
      if (counts) pdos.push_back(frame.frame.identifier);
    }
    ASSERT_EQ(pdos.size(), 41u) << tick_us;
    for (std::uint16_t i = 0; i < 20; ++i) {
      EXPECT_EQ(pdos[i], kFirstRpdo + i);
      EXPECT_EQ(pdos[21u + i], kFirstTpdo + i);
    }
    EXPECT_EQ(pdos[20], kSync);
  }
}

TEST_F(Timing, TargetsTakeEffectWithinFourTenthsOfAMillisecond) {
  std::uint64_t earliest_us = kCycle_us;
  std::uint64_t latest_us = 0;
  for (const RobotRun::Frame& frame : run_->frames()) {
    if (frame.frame.identifier != kSync || frame.start_us < kFirst_us) continue;
    earliest_us = std::min(earliest_us, frame.end_us % kCycle_us);
    latest_us = std::max(latest_us, frame.end_us % kCycle_us);
  }
  EXPECT_GE(earliest_us, 2'500u);
  EXPECT_LE(latest_us, 2'900u);
}

TEST_F(Timing, AnswersAndTelemetryArriveLongBeforeTheNextTick) {
  std::uint64_t answers_us = 0;
  std::uint64_t all_us = 0;
  for (const RobotRun::Frame& frame : run_->frames()) {
    if (frame.start_us < kFirst_us) continue;
    const std::uint64_t tick_us = frame.start_us / kCycle_us * kCycle_us;
    const std::uint16_t identifier = frame.frame.identifier;
    const bool telemetry = std::ranges::count(kTelemetry, identifier) > 0;
    if (is_within(frame, kFirstTpdo)) answers_us = std::max(answers_us, frame.end_us - tick_us);
    if (telemetry) all_us = std::max(all_us, frame.end_us - tick_us);
  }
  EXPECT_LE(answers_us, 5'700u);
  EXPECT_LE(all_us, 6'500u);
}

TEST_F(Timing, LoadsTheBusToAboutHalf) {
  const double load = sim_board::bus_load(before_, after_);
  EXPECT_GE(load, 0.49);
  EXPECT_LE(load, 0.60);
  const std::uint64_t frames = after_.frames - before_.frames;
  EXPECT_NEAR(static_cast<double>(frames), 5'178.0,
              5.0);  // 49 per cycle, two in every tenth, 250 heartbeats, four supply voltages requested
}

// The load that `koboshi model check` prints for this robot bounds that of the simulated bus.
TEST_F(Timing, LoadsTheBusAsComputedFromTheNumberOfDrives) {
  const simulation::BusLoad computed = simulation::bus_load(20, false);
  const double seconds = 1e-6 * static_cast<double>(kLast_us - kFirst_us);
  EXPECT_NEAR(static_cast<double>(after_.frames - before_.frames) / seconds, computed.frames_per_s, 5.0);
  const double load = sim_board::bus_load(before_, after_);
  EXPECT_GT(load, computed.shortest);
  EXPECT_LT(load, computed.longest);
  EXPECT_LT(computed.longest, computed.shortest * 1.25);
}

// Each kind of frame has the size and the rate that the computed load assumes.
TEST_F(Timing, CarriesTheFramesOfTheComputedLoad) {
  std::map<std::pair<std::string_view, int>, double> frames_per_s;
  for (const RobotRun::Frame& frame : run_->frames()) {
    if (frame.start_us < kFirst_us) continue;
    const std::uint16_t identifier = frame.frame.identifier;
    const std::string_view name = identifier == kSync                              ? "SYNC"
                                  : is_within(frame, kFirstRpdo)                   ? "targets of the drives"
                                  : is_within(frame, kFirstTpdo)                   ? "answers of the drives"
                                  : identifier == 0x202                            ? "telemetry of the place"
                                  : identifier == 0x302                            ? "telemetry of the ground"
                                  : std::ranges::count(kTelemetry, identifier) > 0 ? "telemetry"
                                  : identifier > 0x700                             ? "heartbeats"
                                                                                   : "supply readings";
    frames_per_s[{name, frame.frame.size}] += 1.0;
  }
  for (const simulation::BusTraffic& each : simulation::bus_traffic(20, false)) {
    const auto found = frames_per_s.find({each.name, each.bytes});
    ASSERT_NE(found, frames_per_s.end()) << each.name;
    EXPECT_NEAR(found->second, each.frames_per_s, 3.0) << each.name;
    frames_per_s.erase(found);
  }
  EXPECT_TRUE(frames_per_s.empty());
}

}  // namespace
}  // namespace koboshi::test
