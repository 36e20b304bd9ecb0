#include "view/replay/first_difference.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

namespace koboshi::view {
namespace {

using IndexPairs = std::vector<std::pair<std::size_t, std::size_t>>;

// Indices of the elements that have the same name in both lists, in the order of the first.
template <typename Named>
IndexPairs common(const std::vector<Named>& a, const std::vector<Named>& b) {
  IndexPairs pairs;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto other = std::ranges::find(b, a[i].name, &Named::name);
    if (other != b.end()) pairs.emplace_back(i, static_cast<std::size_t>(other - b.begin()));
  }
  return pairs;
}

bool same(float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }

bool same(const Pose& a, const Pose& b) { return a.p_WL_m == b.p_WL_m && a.q_WL.coeffs() == b.q_WL.coeffs(); }

std::string value_text(float value, const std::string& unit) {
  if (std::isnan(value)) return "no value";
  return fmt::format("{}{}{}", value, unit.empty() ? "" : " ", unit);
}

std::string others_text(std::size_t count, std::string_view noun) {
  return count == 0 ? "" : fmt::format(", and {} other {}{}", count, noun, count == 1 ? "" : "s");
}

class Comparison {
 public:
  Comparison(const Recording& a, const Recording& b)
      : a_(a), b_(b), signals_(common(a.signals, b.signals)), links_(common(a.scene.links, b.scene.links)) {}

  std::optional<FirstDifference> of_samples() const {
    const std::size_t count = std::min(a_.samples.size(), b_.samples.size());
    for (std::size_t i = 0; i < count; ++i) {
      const std::string text = of_sample(a_.samples[i], b_.samples[i]);
      if (text.empty()) continue;
      return FirstDifference{std::min(a_.samples[i].time_us, b_.samples[i].time_us), text};
    }
    if (a_.samples.size() == b_.samples.size()) return {};
    const bool first_ends = a_.samples.size() < b_.samples.size();
    const auto& longer = first_ends ? b_.samples : a_.samples;
    return FirstDifference{longer[count].time_us,
                           fmt::format("The {} run has ended.", first_ends ? "first" : "second")};
  }

  std::optional<FirstDifference> of_frames() const {
    const auto [a, b] = std::ranges::mismatch(a_.frames, b_.frames, [](const Frame& one, const Frame& other) {
      return one.end_us == other.end_us && one.frame == other.frame;
    });
    if (a == a_.frames.end() || b == b_.frames.end()) return {};  // of_samples() tells which run is shorter
    if (a->frame.identifier != b->frame.identifier || a->end_us != b->end_us) {
      return FirstDifference{std::min(a->end_us, b->end_us),
                             fmt::format("The frames on the bus differ: {:03X} ends at {:.6f} s in the first "
                                         "run, {:03X} at {:.6f} s in the second.",
                                         a->frame.identifier, 1e-6 * static_cast<double>(a->end_us),
                                         b->frame.identifier, 1e-6 * static_cast<double>(b->end_us))};
    }
    return FirstDifference{
        a->end_us, fmt::format("The frame {:03X} on the bus has different data.", a->frame.identifier)};
  }

 private:
  std::string of_sample(const Sample& a, const Sample& b) const {
    if (a.time_us != b.time_us) return "The ticks have different times.";
    std::string text = of_values(a, b);
    return text.empty() ? of_poses(a, b) : text;
  }

  std::string of_values(const Sample& a, const Sample& b) const {
    std::string text;
    std::size_t others = 0;
    for (const auto& [i, j] : signals_) {
      if (same(a.values[i], b.values[j])) continue;
      const Signal& signal = a_.signals[i];
      if (!text.empty()) {
        ++others;
      } else {
        text = fmt::format("{} is {} in the first run and {} in the second", signal.name,
                           value_text(a.values[i], signal.unit), value_text(b.values[j], signal.unit));
      }
    }
    return text.empty() ? text : text + others_text(others, "signal") + ".";
  }

  std::string of_poses(const Sample& a, const Sample& b) const {
    std::string text;
    std::size_t others = 0;
    for (const auto& [i, j] : links_) {
      if (same(a.links[i], b.links[j])) continue;
      if (!text.empty()) {
        ++others;
      } else {
        text = fmt::format("The pose of {} differs", a_.scene.links[i].name);
      }
    }
    return text.empty() ? text : text + others_text(others, "link") + ".";
  }

  const Recording& a_;
  const Recording& b_;
  const IndexPairs signals_;
  const IndexPairs links_;
};

}  // namespace

std::optional<FirstDifference> first_difference(const Recording& a, const Recording& b) {
  const Comparison comparison(a, b);
  auto samples = comparison.of_samples();
  auto frames = comparison.of_frames();
  if (!samples || !frames) return samples ? samples : frames;
  return frames->time_us < samples->time_us ? frames : samples;
}

}  // namespace koboshi::view
