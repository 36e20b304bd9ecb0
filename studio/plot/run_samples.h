#pragma once

#include <QString>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "studio/plot/series.h"
#include "view/recording/recording.h"

namespace koboshi::studio {

// An event on the time axis.
struct Mark {
  std::uint64_t time_us = 0;
  QString text{};
};

// From here to the next span, or to the last sample, the robot is in a state.
struct StateSpan {
  std::uint64_t start_us = 0;
  std::int64_t state = 0;
};

// The samples and events of a run that is recorded or grows. Traces share its timeline and its series.
class RunSamples {
 public:
  // Forgets everything.
  void set_signals(std::span<const view::Signal> signals);
  // One value per signal; the time is later than that of the last sample. Jumps of angles by a
  // whole turn, at the ends of their range, are removed.
  void append(std::uint64_t time_us, std::span<const float> values);
  // An event that is there already is not added again.
  void add_event(std::uint64_t time_us, const QString& text);
  void truncate_after(std::uint64_t time_us);

  std::span<const view::Signal> signals() const { return signals_; }
  std::optional<std::size_t> index_of(std::string_view name) const;
  bool has(const QString& name) const { return index_of(name.toStdString()).has_value(); }
  std::shared_ptr<const SampleTimes> times() const { return times_; }
  std::shared_ptr<const Series> values(std::size_t signal) const { return values_[signal]; }
  const std::vector<Mark>& marks() const { return marks_; }  // in order of time
  // The states of the signal state_name; without such a signal, none.
  const std::vector<StateSpan>& states() const { return states_; }
  QString state_name(std::int64_t state) const;

 private:
  std::vector<view::Signal> signals_{};
  std::shared_ptr<SampleTimes> times_ = std::make_shared<SampleTimes>();
  std::vector<std::shared_ptr<Series>> values_{};
  std::vector<double> turns_{};  // by signal: a whole turn in its unit; 0: no angle
  std::vector<float> last_{};    // by signal: the last value of an angle
  std::vector<Mark> marks_{};
  std::optional<std::size_t> state_signal_{};
  std::vector<StateSpan> states_{};
};

}  // namespace koboshi::studio
