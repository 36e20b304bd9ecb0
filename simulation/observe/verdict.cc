// Summarises a run from the events of an EventLog.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text/user_units.h"
#include "firmware/app/controller_objects.h"
#include "simulation/observe/event_log.h"
#include "simulation/observe/event_words.h"
#include "simulation/observe/posture.h"

namespace koboshi::simulation {

std::vector<RunEvent> EventLog::events(bool controller_is_dead) const {
  std::vector<RunEvent> events = events_.all();
  for (const GivenCommand& given : given_) {
    const std::string verb(canopen::name_of(app::kCommandNames, static_cast<std::int64_t>(given.command)));
    events.push_back({given.time_us,
                      "command",
                      "Command " + verb + ": no answer until the end.",
                      {{"command", verb}, {"outcome", "unanswered"}}});
  }
  std::ranges::stable_sort(events, {}, &RunEvent::time_us);
  events.push_back({now_us_,
                    "end",
                    "End: " + verdict(controller_is_dead) + ".",
                    {{"state", name_of(said_.state)},
                     {"reason", name_of(said_.reason)},
                     {"tilt_deg", std::round(10.0 * kDegreesPerRad * truth_.tilt_rad) / 10.0},
                     {"stands", stands()}}});
  return events;
}

bool EventLog::stands() const { return is_on_its_feet(said_.state, truth_); }

std::string EventLog::posture(bool controller_is_dead) const {
  const std::uint64_t release_us =
      scenario_.initial.release_us.value_or(std::numeric_limits<std::uint64_t>::max());
  const bool hangs = scenario_.initial.fixed_base && now_us_ < release_us;
  const bool upright = truth_.tilt_rad < kUpAgain_rad;
  std::string state = name_of(said_.state);
  if (said_.state == behaviour::State::kFault) state += ": " + reason_text(said_);
  if (said_.state == behaviour::State::kMotion) state = "plays " + motion_name(said_.motion);
  if (has_not_noticed(said_.state, truth_.tilt_rad)) state = kNotNoticed;
  if (controller_is_dead) state = "its controller is dead";
  if (hangs) return "hangs on its stand, " + state;
  if (upright && !controller_is_dead) {
    if (said_.state == behaviour::State::kStanding) return "stands";
    if (said_.state == behaviour::State::kWalking) return "walks";
    if (said_.state == behaviour::State::kMotion) return state;
    if (said_.state == behaviour::State::kLowBattery) return "stands, its supply low";
    if (said_.state == behaviour::State::kSittingDown) return "sits down, its supply low";
  }
  const bool is_limp_for_its_supply =
      said_.state == behaviour::State::kLimp && said_.reason == behaviour::Reason::kSupplyLow;
  if (is_limp_for_its_supply && truth_.tilt_rad <= kFallen_rad) return "sits, its supply low";
  if (upright) return "is upright, " + state;
  if (truth_.tilt_rad > kFallen_rad) return "lies, " + state;
  return fmt::format("leans by {:.0f} degrees, {}", kDegreesPerRad * truth_.tilt_rad, state);
}

std::string EventLog::verdict(bool controller_is_dead) const {
  std::string text = posture(controller_is_dead) + "; " + falls_text();
  constexpr std::size_t kMaxNamed = 3;
  const auto add_first = [&](const std::vector<std::string>& clauses, const char* rest) {
    for (std::size_t i = 0; i < std::min(clauses.size(), kMaxNamed); ++i) text += "; " + clauses[i];
    if (clauses.size() > kMaxNamed) text += fmt::format("; {} {}", clauses.size() - kMaxNamed, rest);
  };
  add_first(cut_offs_, "more motions ended early");
  add_first(remarks_, "more pairs of links touch each other");
  if (refused_ > 0) text += "; " + count_text(refused_, "command") + " refused";
  return text + "; " + count_text(said_.emergencies, "fault");
}

std::string EventLog::falls_text() const {
  if (falls_.empty()) return "did not fall";
  const auto risen = static_cast<std::size_t>(
      std::ranges::count_if(falls_, [](const Fall& fall) { return fall.up_us.has_value(); }));
  std::uint64_t longest_us = 0;
  for (const Fall& fall : falls_)
    if (fall.up_us) longest_us = std::max(longest_us, *fall.up_us - fall.at_us);
  std::string text =
      falls_.size() == 1 ? "fell once at " : fmt::format("fell {} times, first at ", falls_.size());
  text += seconds_text(falls_.front().at_us, 1);
  if (risen == falls_.size()) {
    const char* const how = falls_.size() == 1 ? " and got up in {}" : " and got up each time, in {} at most";
    return text + fmt::format(fmt::runtime(how), seconds_text(longest_us, 1));
  }
  // If the robot fell again while standing up, the recovery counts from the first fall.
  if (falls_.back().up_us)
    return text + fmt::format(" and finally got up, in {}",
                              seconds_text(*falls_.back().up_us - falls_.front().at_us, 1));
  if (risen > 0) text += fmt::format(", got up {} of them", risen);
  return text + (behaviour::kGettingUp.contains(said_.state) ? " and is getting up" : " and did not get up");
}

}  // namespace koboshi::simulation
