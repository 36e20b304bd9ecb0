#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "lab/experiment/field_table.h"

namespace koboshi::lab {

// How a trial ended. If several apply, the first in this order counts.
enum class Outcome {
  kEnergyGuard,  // the world gained energy or left the finite, and the run ended (sim_board::WorldBlewUp)
  kFailed,       // any other error ended the run
  kFell,         // the trunk leant beyond 60 degrees
  kLowSupply,    // the firmware stopped for a low supply
  kGaveUp,       // the firmware predicted a fall, faulted or stopped in an emergency; the robot did not fall
  kSurvived,
};

// Every outcome but survival is lost, and is an event of its own in the reports.
struct Loss {
  Outcome outcome;
  const char* name;
  const char* label;  // empty: below the table, and only if it happens
};
inline constexpr std::array<Loss, 5> kLosses{{{Outcome::kFell, "fell", "falls"},
                                              {Outcome::kGaveUp, "gave_up", "given up"},
                                              {Outcome::kLowSupply, "low_supply", "low supply"},
                                              {Outcome::kEnergyGuard, "energy_guard", "energy guard"},
                                              {Outcome::kFailed, "failed", ""}}};
// The losses of a trial in which the robot may fall and get up again.
inline constexpr auto kLossesButFalls = std::span(kLosses).subspan<1>();

// The events of a member of a trial that is an Outcome, or an optional one.
template <typename T, typename Member>
Fields<T> outcome_fields(Member member, std::span<const Loss> losses = kLosses) {
  Fields<T> fields;
  for (const Loss& loss : losses) {
    const Outcome outcome = loss.outcome;
    const auto get = [member, outcome](const T& trial) -> std::optional<double> {
      const std::optional<Outcome> had = trial.*member;
      return had ? std::optional(*had == outcome ? 1.0 : 0.0) : std::nullopt;
    };
    const auto set = [member, outcome](T& trial, std::optional<double> happened) {
      const std::optional<Outcome> had = trial.*member;
      if (happened) trial.*member = *happened != 0.0 ? outcome : had.value_or(Outcome::kSurvived);
    };
    fields.push_back({{.name = loss.name, .label = loss.label, .is_event = true, .is_loss = true}, get, set});
  }
  return fields;
}

}  // namespace koboshi::lab
