#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab/experiment/field_table.h"
#include "lab/experiment/report.h"
#include "lab/trial/commanded_walk.h"
#include "lab/trial/loop_gain.h"
#include "lab/trial/outcome.h"

namespace koboshi::lab {

// Gain and phase of the balance feedback over frequency, with the loop broken at the gyro: a sine is added to
// the rate that the gyro senses, and compared with the rate at which the trunk answers
// (lab/trial/loop_gain.h). The loop contains sensor, filters, estimation, feedback, bus, drives and body.
// The path of the accelerometer to the estimated lean stays closed.
//
// Each trial is two runs with opposite sines, whose half difference is what the sine has caused: the gait
// alone is the same in both. The trunk's response is not linear (dead bands, backlash, steps), so that the
// result is that of the amplitude.
struct LoopOptions : ExperimentSetup {
  LoopOptions() : ExperimentSetup{.seeds = 3} {}

  std::vector<std::string> states{"standing", "walking"};
  std::vector<std::string> axes{"pitch", "roll"};
  std::vector<double> frequencies_Hz{0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 11.0, 16.0, 22.0};
  double amplitude_deg_per_s = 40.0;
  double speed_m_per_s = 0.1;  // of the walk
  double shortest_s = 4.0;     // of the measurement, at least kPeriods periods
};

struct LoopTrial {
  Outcome outcome = Outcome::kSurvived;
  std::string error{};
  std::optional<double> gain_real{};  // of L, of a trial that was not lost
  std::optional<double> gain_imaginary{};
};
[[nodiscard]] const FieldTable<LoopTrial>& loop_fields();

// A cell for each state, axis and frequency. It concludes crossover, margins and a Bode plot of the mean over
// the seeds. Throws InputError.
[[nodiscard]] Experiment make_loop(const LoopOptions& options);

}  // namespace koboshi::lab
