// docs/reference/behaviour.md shows kTransitions, and nothing else.

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "firmware/app/controller_objects.h"

namespace koboshi::app {
namespace {

constexpr std::array<std::pair<Event, const char*>, 20> kEvents{{{Event::kReady, "ready"},
                                                                 {Event::kEnable, "enable"},
                                                                 {Event::kEnabled, "enabled"},
                                                                 {Event::kArrived, "arrived"},
                                                                 {Event::kPlay, "play"},
                                                                 {Event::kWalk, "walk"},
                                                                 {Event::kEnded, "ended"},
                                                                 {Event::kLowBattery, "low battery"},
                                                                 {Event::kFall, "fall"},
                                                                 {Event::kDown, "down"},
                                                                 {Event::kGetUp, "get up"},
                                                                 {Event::kStill, "still"},
                                                                 {Event::kLiesFlat, "lies flat"},
                                                                 {Event::kLiesAside, "lies aside"},
                                                                 {Event::kUpright, "upright"},
                                                                 {Event::kElsewhere, "elsewhere"},
                                                                 {Event::kLimp, "limp"},
                                                                 {Event::kTrouble, "trouble"},
                                                                 {Event::kEmergencyStop, "emergency stop"},
                                                                 {Event::kReset, "reset"}}};

std::string name_of(State state) {
  for (const auto& known : kStateNames) {
    if (known.value == static_cast<std::int32_t>(state)) return std::string(known.name);
  }
  return {};
}

std::vector<std::string> expected_table() {
  std::vector<std::string> lines{"| state | torque |", "| --- | --- |"};
  for (const auto& [event, name] : kEvents) {
    lines[0] += std::string(" ") + name + " |";
    lines[1] += " --- |";
  }
  for (const auto& known : kStateNames) {
    const auto state = static_cast<State>(known.value);
    lines.push_back("| " + std::to_string(known.value) + " " + std::string(known.name) + " | " +
                    (makes_torque(state) ? "yes" : "no") + " |");
    for (const auto& [event, name] : kEvents) {
      const auto next = next_state(state, event);
      lines.back() += next ? " " + name_of(*next) + " |" : " |";
    }
  }
  return lines;
}

TEST(BehaviourPage, ShowsTheTransitions) {
  std::ifstream page(KOBOSHI_SOURCE_DIR "/docs/reference/behaviour.md");
  std::vector<std::string> table;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("|")) table.push_back(line);
  }
  const std::vector<std::string> expected = expected_table();
  std::string text;
  for (const std::string& line : expected) text += line + "\n";
  EXPECT_EQ(table, expected) << "the page's table has to be:\n" << text;
}

}  // namespace
}  // namespace koboshi::app
