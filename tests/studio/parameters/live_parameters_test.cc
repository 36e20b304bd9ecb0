#include "studio/parameters/live_parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "simulation/assembly/parameters.h"
#include "studio/parameters/comparison.h"
#include "studio/run/session.h"
#include "tests/studio/parameters/sample_walk.h"

namespace koboshi::studio {
namespace {

std::size_t at(const char* key) { return index_of(controller_table(), key).value(); }

// A simulation with the parameters of its controller.
struct LiveRun {
  Session session{sample_walk()};
  view::Recording recording = session.head();
  LiveParameters live{controller_table(),
                      [this](const simulation::ObjectRequest& request) { session.give(request); }};

  LiveRun() { live.set_known(simulation::controller_values(session.scenario())); }

  void advance(std::uint64_t milliseconds) {
    session.step(milliseconds);
    session.wait();
    Batch batch = session.take();
    if (batch.rewound) live.return_to(batch.rewound->time_us);
    for (const simulation::ObjectAnswer& answer : batch.answers) static_cast<void>(live.take_answer(answer));
    append(std::move(batch), recording);
  }
  void rewind(std::uint64_t time_us) {
    session.rewind(time_us);
    advance(0);
  }
  double speed_m_per_s() const {
    return trunk_quantity(recording, recording.samples.size() - 1, TrunkQuantity::kSpeed);
  }
};

TEST(LiveParameters, AreKnownAtTheStartOfARun) {
  LiveRun run;
  EXPECT_EQ(run.live.state(at("step_time_ms")).in_force, 170.0);
  EXPECT_EQ(run.live.state(at("fall_lead_ms")).in_force, 135.0);
  run.advance(1000);
  run.live.read(at("fall_lead_ms"));
  run.advance(100);
  EXPECT_EQ(run.live.state(at("fall_lead_ms")).in_force, 135.0);
}

// The walking robot obeys a lower velocity limit at once. The write is an input of the run: after a rewind
// the run repeats it with the same bits, and a rewind to before it takes it back.
TEST(LiveParameters, ChangeTheSpeedOfAWalkingRobotAndComeAgainAfterARewind) {
  LiveRun run;
  run.advance(7000);
  const double before_m_per_s = run.speed_m_per_s();
  EXPECT_GT(before_m_per_s, 0.15);
  run.live.write(at("highest_velocity_forward_mm_per_s"), 60.0);
  EXPECT_TRUE(run.live.state(at("highest_velocity_forward_mm_per_s")).is_pending);
  run.advance(2500);
  EXPECT_FALSE(run.live.state(at("highest_velocity_forward_mm_per_s")).is_pending);
  EXPECT_EQ(run.live.state(at("highest_velocity_forward_mm_per_s")).in_force, 60.0);
  EXPECT_LT(run.speed_m_per_s(), 0.09);
  const std::uint64_t hash = run.session.state_hash();

  run.rewind(8'000'000);
  EXPECT_EQ(run.live.state(at("highest_velocity_forward_mm_per_s")).in_force, 60.0);
  run.advance(1500);
  EXPECT_EQ(run.session.state_hash(), hash);

  run.rewind(6'900'000);
  EXPECT_EQ(run.live.state(at("highest_velocity_forward_mm_per_s")).in_force, 330.0);
  run.advance(2600);
  EXPECT_GT(run.speed_m_per_s(), 0.15);
}

TEST(LiveParameters, AreRefusedByTheControllerWithItsReason) {
  LiveRun run;
  run.advance(3500);  // with torque
  run.live.write(at("mounting_roll_deg"), 1.0);
  run.advance(100);
  const LiveParameters::State& state = run.live.state(at("mounting_roll_deg"));
  EXPECT_FALSE(state.is_pending);
  EXPECT_THAT(state.refusal, testing::HasSubstr("device state"));
  EXPECT_EQ(state.in_force, 0.0);
}

TEST(LiveParameters, OfASliderFollowWithoutFillingTheBus) {
  LiveRun run;
  run.advance(1000);
  for (int lead = 100; lead <= 200; ++lead) run.live.write(at("fall_lead_ms"), lead);
  for (int i = 0; i < 5; ++i) run.advance(20);  // two writes
  EXPECT_EQ(run.live.state(at("fall_lead_ms")).in_force, 200.0);
  EXPECT_FALSE(run.live.state(at("fall_lead_ms")).is_pending);
}

// A controller that boots does not answer: the write is repeated.
TEST(LiveParameters, ReachAControllerThatBoots) {
  LiveRun run;
  run.live.write(at("fall_lead_ms"), 150.0);
  for (int i = 0; i < 20 && run.live.state(at("fall_lead_ms")).is_pending; ++i) run.advance(100);
  EXPECT_EQ(run.live.state(at("fall_lead_ms")).in_force, 150.0);
}

// A walking robot takes a new gait within two steps.
TEST(LiveParameters, OfTheGaitChangeTheWalkOfARobot) {
  LiveRun run;
  LiveRun other;
  run.advance(5500);
  other.advance(5500);
  const auto lift_m = [](const LiveRun& walk) {
    double most_m = 0.0;
    const auto& samples = walk.recording.samples;
    const auto foot = static_cast<std::size_t>(walk.recording.scene.sole_links[0]);
    for (std::size_t i = samples.size() - 100; i < samples.size(); ++i)
      most_m = std::max(most_m, static_cast<double>(samples[i].links[foot].p_WL_m.z()));
    return most_m;
  };
  run.live.write(at("step_height_mm"), 60.0);
  run.advance(1500);
  other.advance(1500);
  EXPECT_EQ(run.live.state(at("step_height_mm")).in_force, 60.0);
  EXPECT_GT(lift_m(run), lift_m(other) + 0.005);
}

}  // namespace
}  // namespace koboshi::studio
