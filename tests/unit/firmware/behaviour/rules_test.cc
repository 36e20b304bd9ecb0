// Tests the transition rules: one result for each state and event, and no path to torque except by a command
// or once the robot is at rest.

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "firmware/behaviour/state.h"

namespace koboshi::behaviour {
namespace {

constexpr auto kLastEvent = static_cast<int>(Event::kFailure);

std::vector<State> states() {
  std::vector<State> all;
  for (const StateRow& row : kStates) all.push_back(row.state);
  return all;
}

std::vector<Event> events() {
  std::vector<Event> all;
  for (int i = 0; i <= kLastEvent; ++i) all.push_back(static_cast<Event>(i));
  return all;
}

int rules_for(State state, Event event) {
  int count = 0;
  for (const Rule& rule : kRules) count += rule.event == event && rule.from.contains(state) ? 1 : 0;
  return count;
}

// Returns all states that are reachable from this one by any events.
std::set<State> reachable_from(State start) {
  std::set<State> seen{start};
  std::vector<State> open{start};
  while (!open.empty()) {
    const State state = open.back();
    open.pop_back();
    for (const Event event : events()) {
      const auto next = next_state(state, event);
      if (next && seen.insert(*next).second) open.push_back(*next);
    }
  }
  return seen;
}

TEST(Rules, AreUniqueForAStateAndEvent) {
  for (const State state : states()) {
    for (const Event event : events())
      EXPECT_LE(rules_for(state, event), 1) << static_cast<int>(state) << ' ' << static_cast<int>(event);
  }
}

TEST(Rules, UseEveryEvent) {
  for (const Event event : events()) {
    bool used = false;
    for (const State state : states()) used = used || next_state(state, event).has_value();
    EXPECT_TRUE(used) << static_cast<int>(event);
  }
}

TEST(Rules, LeadFromTheBootToEveryState) { EXPECT_EQ(reachable_from(State::kBoot).size(), states().size()); }

TEST(Rules, LeadFromEveryStateBackToTheBoot) {
  for (const State state : states()) EXPECT_TRUE(reachable_from(state).contains(State::kBoot));
}

TEST(Rules, LeaveStatesWithoutTorqueOnlyByACommandOrAtRest) {
  for (const State state : states()) {
    for (const Event event : events()) {
      const auto next = next_state(state, event);
      if (!next || !kTorque.contains(*next) || kTorque.contains(state)) continue;
      const bool enabled = state == State::kLimp && event == Event::kEnable;
      const bool gets_up = state == State::kFallen && event == Event::kStill;
      EXPECT_TRUE(enabled || gets_up) << static_cast<int>(state) << ' ' << static_cast<int>(event);
    }
  }
}

TEST(Rules, CutTheTorqueFromEveryStateAtOnce) {
  for (const State state : states()) {
    if (!kTorque.contains(state)) continue;
    EXPECT_EQ(next_state(state, Event::kLimp), State::kLimp);
    EXPECT_EQ(next_state(state, Event::kFailure), State::kFault);
    EXPECT_EQ(next_state(state, Event::kEmergencyStop), State::kEmergencyStop);
  }
}

TEST(Rules, LeaveALatchedStateOnlyByReset) {
  for (const Event event : events()) {
    if (event == Event::kReset) continue;
    EXPECT_EQ(next_state(State::kEmergencyStop, event), std::nullopt);
    if (event == Event::kEmergencyStop) continue;
    EXPECT_EQ(next_state(State::kFault, event), std::nullopt);
  }
}

TEST(States, FormSets) {
  constexpr States kTwo{State::kBoot, State::kLimp};
  static_assert(kTwo.contains(State::kBoot) && !kTwo.contains(State::kFault));
  static_assert(!(~kTwo).contains(State::kBoot) && (~kTwo).contains(State::kSteadying));
  static_assert((kTwo | States{State::kFault}).contains(State::kFault));
}

}  // namespace
}  // namespace koboshi::behaviour
