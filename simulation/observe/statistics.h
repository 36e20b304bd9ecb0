#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace koboshi::simulation {

// Returns the percentile of the values for a share of 0 to 1, interpolated linearly; NaN without values.
inline double percentile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::ranges::sort(values);
  const double place = share * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(place);
  const std::size_t high = std::min(low + 1, values.size() - 1);
  return values[low] + (place - std::floor(place)) * (values[high] - values[low]);
}

// Root mean square; NaN without values.
class RootMeanSquare {
 public:
  void add(double square) {
    sum_ += square;
    ++count_;
  }
  double value() const { return std::sqrt(sum_ / static_cast<double>(count_)); }

 private:
  double sum_ = 0.0;
  long count_ = 0;
};

}  // namespace koboshi::simulation
