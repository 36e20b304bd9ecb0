#include "studio/plot/run_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/fixed/contract.h"
#include "tools/plot/unwrap.h"

namespace koboshi::studio {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

float last_finite(const Series& values) {
  for (std::size_t i = values.size(); i-- > 0;)
    if (std::isfinite(values[i])) return values[i];
  return kNone;
}

}  // namespace

void RunSamples::set_signals(std::span<const view::Signal> signals) {
  signals_.assign(signals.begin(), signals.end());
  times_ = std::make_shared<SampleTimes>();
  values_.clear();
  turns_.clear();
  for (const view::Signal& signal : signals) {
    values_.push_back(std::make_shared<Series>());
    turns_.push_back(tools::turn_of(signal.unit));
  }
  last_.assign(signals.size(), kNone);
  marks_.clear();
  states_.clear();
  state_signal_ = index_of("state_name");
}

void RunSamples::append(std::uint64_t time_us, std::span<const float> values) {
  KOBOSHI_ASSERT(values.size() == values_.size());
  times_->append(time_us);
  for (std::size_t i = 0; i < values.size(); ++i) {
    float value = values[i];
    if (turns_[i] != 0.0 && std::isfinite(value))
      last_[i] = value = static_cast<float>(
          tools::unwrapped(static_cast<double>(last_[i]), static_cast<double>(value), turns_[i]));
    values_[i]->append(value);
  }
  if (!state_signal_ || !std::isfinite(values[*state_signal_])) return;
  const auto state = std::llround(values[*state_signal_]);
  if (states_.empty() || states_.back().state != state) states_.push_back({time_us, state});
}

void RunSamples::add_event(std::uint64_t time_us, const QString& text) {
  const auto same_time = std::ranges::equal_range(marks_, time_us, {}, &Mark::time_us);
  if (std::ranges::find(same_time, text, &Mark::text) != same_time.end()) return;
  marks_.insert(same_time.end(), {time_us, text});
}

void RunSamples::truncate_after(std::uint64_t time_us) {
  const std::size_t size = times_->count_until(time_us);
  times_->truncate(size);
  for (std::size_t i = 0; i < values_.size(); ++i) {
    values_[i]->truncate(size);
    if (turns_[i] != 0.0) last_[i] = last_finite(*values_[i]);
  }
  std::erase_if(marks_, [time_us](const Mark& mark) { return mark.time_us > time_us; });
  std::erase_if(states_, [time_us](const StateSpan& span) { return span.start_us > time_us; });
}

std::optional<std::size_t> RunSamples::index_of(std::string_view name) const {
  const auto found = std::ranges::find(signals_, name, &view::Signal::name);
  if (found == signals_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - signals_.begin());
}

QString RunSamples::state_name(std::int64_t state) const {
  if (!state_signal_) return {};
  for (const auto& [value, name] : signals_[*state_signal_].names)
    if (value == state) return QString::fromStdString(name).replace(QLatin1Char('_'), QLatin1Char(' '));
  return QString::number(state);
}

}  // namespace koboshi::studio
