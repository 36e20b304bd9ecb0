// Compares docs/reference/behaviour.md with the rules of firmware/behaviour/state.h, in both directions.

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/app/controller_objects.h"

namespace koboshi::behaviour {
namespace {

constexpr std::string_view kEventNames[] = {"ready",       "enable",
                                            "limp",        "play",
                                            "walk",        "stream",
                                            "reset",       "emergency stop",
                                            "enabled",     "get up",
                                            "ended",       "pushed",
                                            "low battery", "sit down",
                                            "fall",        "down",
                                            "still",       "prone or supine",
                                            "on side",     "upright",
                                            "steady",      "recovery step failed",
                                            "failure"};
static_assert(std::size(kEventNames) == static_cast<std::size_t>(Event::kFailure) + 1);

std::string name_of(State state) {
  for (const auto& known : app::kStateNames) {
    if (known.value == static_cast<std::int32_t>(state)) return std::string(known.name);
  }
  return {};
}

// Returns the identifier of a state in the Mermaid diagram.
std::string identifier(State state) {
  std::string name = name_of(state);
  std::ranges::replace(name, ' ', '_');
  return name;
}

std::vector<State> states_of(const States& set) {
  std::vector<State> states;
  for (const auto& known : app::kStateNames) {
    const auto state = static_cast<State>(known.value);
    if (set.contains(state)) states.push_back(state);
  }
  return states;
}

constexpr std::size_t kFewStates = 4;  // a rule for more states becomes a row of the table instead of arrows

std::string diagram() {
  std::string text = "```mermaid\nstateDiagram-v2\n";
  for (const auto& known : app::kStateNames) {
    const auto state = static_cast<State>(known.value);
    if (identifier(state) != name_of(state)) text += "  " + identifier(state) + " : " + name_of(state) + "\n";
  }
  text += "  [*] --> boot\n";
  for (const Rule& rule : kRules) {
    const auto from = states_of(rule.from);
    if (from.size() > kFewStates) continue;
    for (const State state : from) {
      text += "  " + identifier(state) + " --> " + identifier(rule.to) + " : " +
              std::string(kEventNames[static_cast<std::size_t>(rule.event)]) + "\n";
    }
  }
  return text + "```\n";
}

std::string table() {
  std::string text = "| in these states | leads | to |\n| --- | --- | --- |\n";
  for (const Rule& rule : kRules) {
    const auto from = states_of(rule.from);
    if (from.size() <= kFewStates) continue;
    const auto others = states_of(~rule.from);
    const bool nearly_all = others.size() < from.size();
    std::string list = nearly_all ? "all but " : "";
    const auto& named = nearly_all ? others : from;
    for (std::size_t i = 0; i < named.size(); ++i) list += (i == 0 ? "" : ", ") + name_of(named[i]);
    text += "| " + list + " | *" + std::string(kEventNames[static_cast<std::size_t>(rule.event)]) + "* | " +
            name_of(rule.to) + " |\n";
  }
  return text;
}

TEST(BehaviourPage, ShowsTheRules) {
  std::ifstream file(KOBOSHI_SOURCE_DIR "/docs/reference/behaviour.md");
  std::ostringstream page;
  page << file.rdbuf();
  for (const std::string& part : {diagram(), table()})
    EXPECT_NE(page.str().find(part), std::string::npos) << "the page has to have:\n" << part;
}

TEST(BehaviourPage, StatesWhichStatesHaveTorque) {
  std::ifstream file(KOBOSHI_SOURCE_DIR "/docs/reference/behaviour.md");
  std::ostringstream page;
  page << file.rdbuf();
  for (const auto& known : app::kStateNames) {
    const bool torque = kTorque.contains(static_cast<State>(known.value));
    const std::string row = "| " + std::to_string(known.value) + " | " + std::string(known.name) + " | " +
                            (torque ? "yes" : "no") + " |";
    EXPECT_NE(page.str().find(row), std::string::npos) << "the page has no row that begins with " << row;
  }
}

}  // namespace
}  // namespace koboshi::behaviour
