#include "studio/run/session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "simulation/scenario/reader.h"
#include "studio/run/bus_load.h"

namespace koboshi::studio {
namespace {

using State = SessionStatus::State;

simulation::Scenario walk() { return simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/walk.yaml"); }

simulation::Push shove() {
  simulation::Push push;
  push.duration_us = 100'000;
  push.link.text = "trunk";
  push.force_W_N = {4.0, 1.0, 0.0};
  return push;
}

// Everything that a session has recorded.
struct Shown {
  view::Recording recording;

  explicit Shown(const Session& session) : recording(session.head()) {}
  void update(Session& session) {
    session.wait();
    append(session.take(), recording);
  }
};

void expect_same(const view::Recording& a, const view::Recording& b) {
  ASSERT_EQ(a.samples.size(), b.samples.size());
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    ASSERT_EQ(a.samples[i].time_us, b.samples[i].time_us);
    for (std::size_t link = 0; link < a.samples[i].links.size(); ++link)
      ASSERT_EQ(a.samples[i].links[link].p_WL_m, b.samples[i].links[link].p_WL_m) << "sample " << i;
  }
  for (std::size_t i = 0; i < std::min(a.frames.size(), b.frames.size()); ++i)
    ASSERT_EQ(a.frames[i].end_us, b.frames[i].end_us) << "frame " << i;
  ASSERT_EQ(a.frames.size(), b.frames.size());
  ASSERT_EQ(a.events.size(), b.events.size());
  for (std::size_t i = 0; i < a.events.size(); ++i) ASSERT_EQ(a.events[i].text, b.events[i].text);
  ASSERT_EQ(a.pushes.size(), b.pushes.size());
}

TEST(Session, RecordsASampleForEachTick) {
  Session session(walk());
  Shown shown(session);
  session.step(2500);
  shown.update(session);
  ASSERT_EQ(shown.recording.samples.size(), 250U);
  EXPECT_EQ(shown.recording.samples.front().time_us, 10'000U);
  EXPECT_EQ(shown.recording.samples.back().time_us, 2'500'000U);
  EXPECT_GT(shown.recording.frames.size(), 1000U);
  EXPECT_FALSE(shown.recording.events.empty());
  EXPECT_EQ(session.status().state, State::kPaused);
  EXPECT_EQ(session.status().time_us, 2'500'000U);
}

// Two ways: the simulated bus counts its bits while it is busy, and the recorded frames have theirs.
TEST(Session, MeasuresTheLoadOfItsBus) {
  Session session(walk());
  Shown shown(session);
  session.step(2500);
  shown.update(session);
  const double of_frames = load_of_frames(shown.recording.frames, 2'500'000, 100'000);
  EXPECT_NEAR(session.status().bus_load, of_frames, 0.003);
  EXPECT_GT(of_frames, 0.2);
  EXPECT_LT(of_frames, 0.9);
}

TEST(Session, GoesOnAfterARewindWithTheSameBits) {
  Session straight(walk());
  straight.step(3200);
  straight.give(shove());
  straight.step(2600);
  Shown expected(straight);
  expected.update(straight);

  Session session(walk());
  Shown shown(session);
  session.step(3200);
  session.give(shove());
  session.step(1700);
  shown.update(session);  // batches before and after a rewind differ
  for (const std::uint64_t time_us : {4'321'000U, 3'555'000U, 3'201'000U}) {
    session.rewind(time_us);
    session.step(500);
    shown.update(session);
    EXPECT_EQ(session.status().time_us, time_us + 500'000U);
    EXPECT_EQ(shown.recording.samples.back().time_us, (time_us + 500'000U) / 10'000U * 10'000U);
  }
  session.step(5800 - 3701);
  shown.update(session);
  EXPECT_EQ(session.state_hash(), straight.state_hash());
  expect_same(shown.recording, expected.recording);
}

TEST(Session, ForgetsInputsFromTheMomentOfARewindOn) {
  Session straight(walk());
  straight.step(4500);

  Session session(walk());
  Shown shown(session);
  session.step(3200);
  session.give(shove());
  session.step(700);
  EXPECT_EQ(session.played().pushes.size(), 1U);
  shown.update(session);
  EXPECT_EQ(shown.recording.pushes.size(), 1U);
  session.rewind(3'200'000);
  session.step(1300);
  EXPECT_TRUE(session.played().pushes.empty());
  EXPECT_EQ(session.state_hash(), straight.state_hash());
  shown.update(session);
  EXPECT_TRUE(shown.recording.pushes.empty());
}

TEST(Session, AcceptsOtherInputsAfterARewind) {
  Session session(walk());
  session.step(3500);
  const std::uint64_t before = session.state_hash();
  session.rewind(3'050'000);
  session.give(shove());
  session.step(450);
  EXPECT_NE(session.state_hash(), before);
}

TEST(Session, ThinsSnapshotsToItsBudgetAndStillReachesEveryMoment) {
  const std::size_t one_bytes = Session(walk()).status().snapshot_bytes;
  Session session(walk(), {.snapshot_budget_bytes = 4 * one_bytes});
  session.step(3500);
  const std::uint64_t hash = session.state_hash();
  session.step(2500);
  session.wait();
  EXPECT_LE(session.status().snapshot_bytes, 4 * one_bytes);
  EXPECT_GT(session.status().snapshot_interval_us, SnapshotStore::kFirstInterval_us);
  session.rewind(3'500'000);
  EXPECT_EQ(session.state_hash(), hash);
}

TEST(Session, RefusesAnInputThatAScenarioCouldNotContain) {
  Session session(walk());
  session.step(100);
  const std::uint64_t hash = session.state_hash();
  simulation::Push push = shove();
  push.link.text = "tail";
  session.give(push);
  session.wait();
  EXPECT_NE(session.status().message.find("tail"), std::string::npos) << session.status().message;
  EXPECT_EQ(session.state_hash(), hash);
}

TEST(Session, PausesOnceAtTheEndOfTheScenario) {
  simulation::Scenario scenario = walk();
  scenario.duration_us = 200'000;
  Session session(scenario);
  session.set_speed(Session::kUnpaced);
  session.start();
  // One status a turn: between two of them the run may start.
  const auto at_rest = [](const SessionStatus& now) {
    return now.state == State::kPaused && now.time_us > 0;
  };
  while (!at_rest(session.status())) std::this_thread::yield();
  ASSERT_EQ(session.status().time_us, 200'000U);
  session.start();
  while (session.status().time_us < 300'000U) std::this_thread::yield();
  session.pause();
  session.wait();
  EXPECT_EQ(session.status().state, State::kPaused);
}

TEST(Session, KeepsToTheWallClock) {
  // A clock that only waiting advances.
  auto now = std::make_shared<std::atomic<std::int64_t>>(0);
  tools::WallClock wall;
  wall.now = [now] { return tools::WallClock::Time(std::chrono::nanoseconds(now->load())); };
  wall.sleep_until = [now](tools::WallClock::Time due) { now->store(due.time_since_epoch().count()); };
  Session session(walk(), {.wall = wall});
  session.set_speed(0.25);
  session.start();
  while (session.status().time_us < 100'000U) std::this_thread::yield();
  session.pause();
  session.wait();
  const double simulated_s = 1e-6 * static_cast<double>(session.status().time_us);
  EXPECT_NEAR(1e-9 * static_cast<double>(now->load()), 4.0 * simulated_s, 0.005);
}

TEST(Session, SeveralRunSideBySide) {
  Session first(walk());
  Session second(walk());
  first.step(1000);
  second.step(1000);
  EXPECT_EQ(first.state_hash(), second.state_hash());
}

// Waits for the answers of the requests so far, which take a few milliseconds each.
std::vector<simulation::ObjectAnswer> answers_of(Session& session) {
  session.step(300);
  session.wait();
  return session.take().answers;
}

simulation::ObjectRequest request(std::uint64_t number, std::uint8_t node, canopen::ObjectAddress address,
                                  std::vector<std::uint8_t> data = {}) {
  return {.number = number, .node_id = node, .address = address, .data = std::move(data)};
}

TEST(Session, ReadsAndWritesObjectsOfRunningNodes) {
  constexpr std::uint8_t kKnee = 19;
  constexpr canopen::ObjectAddress kProfileVelocity{0x6081, 0};
  Session session(walk());
  session.step(2000);
  session.give(request(1, 1, {0x1005, 0}));
  session.give(request(2, kKnee, {0x1008, 0}));
  session.give(request(3, kKnee, kProfileVelocity, {0x10, 0x27, 0, 0}));
  session.give(request(4, kKnee, kProfileVelocity));
  session.give(request(5, kKnee, {0x5FFF, 0}));
  session.give(request(6, 99, {0x1000, 0}));
  const auto answers = answers_of(session);
  ASSERT_EQ(answers.size(), 6U);
  for (std::size_t i = 0; i < answers.size(); ++i) EXPECT_EQ(answers[i].number, i + 1);
  EXPECT_EQ(answers[0].data, (std::vector<std::uint8_t>{0x80, 0x00, 0x00, 0x40}));
  EXPECT_GT(answers[1].data.size(), 4U);
  EXPECT_EQ(answers[2].abort, canopen::AbortCode::kNone);
  EXPECT_EQ(answers[3].data, (std::vector<std::uint8_t>{0x10, 0x27, 0, 0}));
  EXPECT_EQ(answers[4].abort, canopen::AbortCode::kObjectDoesNotExist);
  EXPECT_EQ(answers[5].abort, canopen::AbortCode::kTimedOut);
}

// A reading of an object is an input as any other: it comes again after a rewind, and its answer does not.
TEST(Session, RepeatsAccessesToObjectsInARewind) {
  const auto play = [](Session& session) {
    session.step(1500);
    session.give(request(1, 1, {0x1005, 0}));
    session.step(700);
  };
  Session straight(walk());
  play(straight);
  straight.step(800);
  Session rewound(walk());
  play(rewound);
  rewound.step(300);
  rewound.wait();
  EXPECT_EQ(rewound.take().answers.size(), 1U);
  rewound.rewind(2'200'000);
  rewound.step(800);
  EXPECT_EQ(rewound.state_hash(), straight.state_hash());
  EXPECT_TRUE(rewound.take().answers.empty());
}

TEST(Session, CausesAFaultAndRewindsIt) {
  simulation::Fault fault;
  fault.kind = simulation::Fault::Kind::kDrivePowerLoss;
  fault.target.text = "right_hip_pitch";
  Session session(walk());
  session.step(2000);
  session.give(fault);
  session.step(1000);
  session.wait();
  const auto unpowered = [&] {
    return std::ranges::count(session.status().nodes, false, &NodeStatus::powered);
  };
  EXPECT_EQ(unpowered(), 1);
  ASSERT_EQ(session.played().faults.size(), 1U);
  EXPECT_EQ(session.played().faults[0].at_us, 2'000'000U);
  session.rewind(1'900'000);
  session.step(1100);
  session.wait();
  EXPECT_EQ(unpowered(), 0);
  EXPECT_TRUE(session.played().faults.empty());
  Session undisturbed(walk());
  undisturbed.step(3000);
  EXPECT_EQ(session.state_hash(), undisturbed.state_hash());
}

TEST(Session, RefusesFaultsThatAScenarioCouldNotContain) {
  Session session(walk());
  session.step(100);
  simulation::Fault fault;
  fault.kind = simulation::Fault::Kind::kEncoderBreak;
  fault.target.text = "left_kneee";
  session.give(fault);
  session.wait();
  EXPECT_NE(session.status().message.find("left_knee"), std::string::npos) << session.status().message;
  fault.kind = simulation::Fault::Kind::kBabblingNode;
  fault.target.text.clear();
  session.give(fault);
  session.wait();
  EXPECT_NE(session.status().message.find("babbling_node"), std::string::npos) << session.status().message;
}

}  // namespace
}  // namespace koboshi::studio
