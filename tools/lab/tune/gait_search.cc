#include "tools/lab/tune/gait_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim_board/input/error.h"
#include "sim_board/input/text.h"
#include "sim_board/record/output_file.h"
#include "sim_board/record/output_folder.h"
#include "tools/lab/trial/outcome.h"
#include "tools/lab/tune/infeasible.h"
#include "tools/lab/tune/optimiser.h"

namespace koboshi::tools {
namespace {

// A fall at once, and the best fall there is.
constexpr double kWorst = -1.0;
// What a drift as long as the way costs, and a slide of a metre.
constexpr double kDriftCost_m_per_s = 0.1;
constexpr double kSlipCost_per_s = 0.5;
constexpr double kShortestWay_m = 0.1;  // so that who stays where it is does not divide by nothing

// {period_s: 0.5, feedback.knee_s: 0.01}
std::string flow_map(const GaitNumbers& numbers) {
  std::string text;
  for (const auto& [key, value] : numbers) {
    text += (text.empty() ? "{" : ", ") + key + ": " + sim::number_text(value);
  }
  return text + "}";
}

double duration_of(const GyroFeedbackOptions& options) {
  const sim::Scenario scenario =
      gyro_feedback_scenario(options, options.points.front(), options.feedback.front());
  return 1e-6 * static_cast<double>(scenario.duration_us);
}

class GaitSearch {
 public:
  GaitSearch(const GaitSearchOptions& options, const std::function<void(const GaitSearchProgress&)>& progress)
      : options_(options),
        progress_(progress),
        text_(sim::read_text_file(options.start, "a gait file")),
        duration_s_(duration_of(options.experiment)),
        log_(options.out / "evaluations.csv") {
    for (const SearchedNumber& number : searched_numbers()) {
      const bool effective = !number.gain || options.experiment.feedback.front();
      if (effective && has_number(text_, number.key)) numbers_.push_back(number);
    }
    std::string head = "evaluation";
    for (const SearchedNumber& number : numbers_) head += "," + number.key;
    log_.write(head + ",foot_lift_m,reward_m_per_s\n");
  }

  GaitSearchResult search() {
    std::vector<double> start;
    for (const SearchedNumber& number : numbers_) {
      const double value = gait_number(text_, number.key, options_.start);
      start.push_back(std::clamp((value - number.low) / (number.high - number.low), 0.0, 1.0));
    }
    const std::vector<double> best =
        minimise([this](const std::vector<double>& x) { return evaluate(x); }, start,
                 {.evaluations = options_.evaluations, .spread = options_.spread});
    log_.close();
    GaitSearchResult result{.numbers = numbers_of(best),
                            .reward = best_,
                            .text = {},
                            .evaluations = done_,
                            .infeasible = infeasible_.counts()};
    result.text = with_numbers(text_, result.numbers, options_.start);
    sim::write_whole_file(options_.out / "gait.yaml", result.text);
    return result;
  }

 private:
  // On their grids, so that a file is fit to be read and what was evaluated is what it says.
  GaitNumbers numbers_of(const std::vector<double>& x) const {
    GaitNumbers result;
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
      const double value = numbers_[i].low + x[i] * (numbers_[i].high - numbers_[i].low);
      const double per_unit = std::round(1.0 / numbers_[i].grid);  // exact, as 0.02 is not
      result[numbers_[i].key] = std::round(value * per_unit) / per_unit;
    }
    return result;
  }

  double evaluate(const std::vector<double>& x) {
    const GaitNumbers numbers = numbers_of(x);
    const double reward = mean_reward(numbers);
    best_ = std::max(best_, reward);
    std::string line = std::to_string(++done_);
    for (const SearchedNumber& number : numbers_) line += "," + sim::number_text(numbers.at(number.key));
    log_.write(line + "," + sim::number_text(lift_m_) + "," + sim::number_text(reward) + "\n");
    if (progress_) progress_({done_, options_.evaluations, reward, best_});
    return -reward;
  }

  double mean_reward(const GaitNumbers& numbers) {
    lift_m_ = std::numeric_limits<double>::quiet_NaN();
    GyroFeedbackOptions options = options_.experiment;
    options.overrides.push_back(
        {"gait.file", "\"" + std::filesystem::absolute(options_.start).string() + "\""});
    options.overrides.push_back({"gait.set", flow_map(numbers)});
    const Experiment experiment = make_gyro_feedback(options);
    try {
      const ExperimentResult result = play_experiment(
          experiment, {.log = options_.out / "trials.jsonl", .jobs = options_.jobs, .batch = options.seeds});
      double sum = 0.0;
      for (const Trial& trial : result.cells.front().played) sum += reward(trial.values, duration_s_);
      lift_m_ = mean_of(result.cells.front(), {.name = "foot_lift_m"}).mean;
      return sum / static_cast<double>(options.seeds);
    } catch (const sim::InputError& error) {
      if (done_ == 0) throw;  // the file that the search begins with is wrong
      infeasible_.add(error);
      return kWorst;
    }
  }

  const GaitSearchOptions& options_;
  const std::function<void(const GaitSearchProgress&)>& progress_;
  const std::string text_;
  const double duration_s_;  // of a trial that does not end with a fall
  sim::OutputFile log_;
  std::vector<SearchedNumber> numbers_;
  InfeasibleCounter infeasible_;
  std::size_t done_ = 0;
  // Achieved in the last evaluation: legs and ground that give way leave less of what the gait asks for. Not
  // a number without a whole step.
  double lift_m_ = 0.0;
  double best_ = -std::numeric_limits<double>::infinity();
};

}  // namespace

std::vector<SearchedNumber> searched_numbers() {
  // Half a period is a whole number of ticks: otherwise left and right steps are sampled differently, and
  // the robot turns. A foot that clears an ideal floor by a few millimetres, as fast walks would have it,
  // stumbles over any real one.
  constexpr double kTwoTicks_s = 0.02;
  return {{"period_s", 0.3, 1.0, false, kTwoTicks_s},
          {"step_length_m", 0.01, 0.08},
          {"step_width_m", 0.055, 0.085},
          {"step_height_m", 0.015, 0.035},
          {"swing_ease", 0.0, 1.0},
          {"com_height_m", 0.15, 0.19},
          {"double_support", 0.03, 0.6},
          {"trunk_pitch_deg", -4.0, 12.0},
          {"zmp_ahead_m", -0.015, 0.03},
          {"zmp_inward_m", -0.01, 0.02},
          {"sag_compensation", 0.0, 1.2},
          {"feedback.ankle_pitch_s", 0.0, 0.12, true},
          {"feedback.ankle_roll_s", 0.0, 0.12, true},
          {"feedback.hip_roll_s", 0.0, 0.12, true},
          {"feedback.knee_s", 0.0, 0.12, true}};
}

double reward(const Values& values, double duration_s) {
  if (!values.contains("distance_m")) return kWorst;  // it has not even begun
  if (values.at(kLost) != 0.0) return kWorst * (1.0 - values.at("duration_s") / duration_s);
  const double way_m = std::max(std::abs(values.at("distance_m")), kShortestWay_m);
  const double drift = std::min(1.0, std::abs(values.at("lateral_drift_m")) / way_m);
  return values.at("speed_m_per_s") - kDriftCost_m_per_s * drift -
         kSlipCost_per_s * values.at("foot_slip_max_m");
}

GaitSearchResult search_gait(const GaitSearchOptions& options,
                             const std::function<void(const GaitSearchProgress&)>& progress) {
  std::filesystem::create_directories(options.out);
  const sim::FolderLock lock(options.out);
  return GaitSearch(options, progress).search();
}

}  // namespace koboshi::tools
