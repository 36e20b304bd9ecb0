#pragma once

#include <cstddef>
#include <span>

namespace koboshi::lab {

struct Interval {
  double low = 0.0;
  double high = 0.0;

  double half_width() const { return 0.5 * (high - low); }
  friend bool operator==(const Interval&, const Interval&) = default;
};

// Mean of independent values of a quantity. The mean of no value, and the deviation and interval of fewer
// than two, are NaN.
struct MeanEstimate {
  std::size_t count = 0;
  double mean = 0.0;
  double standard_deviation = 0.0;  // of the values, with n - 1
  Interval confidence_95;           // of the mean, by Student's t
};

MeanEstimate estimate_mean(std::span<const double> values);

// Share of independent trials that had an event.
struct ShareEstimate {
  std::size_t count = 0;
  std::size_t events = 0;
  double share = 0.0;      // not a number without trials
  Interval confidence_95;  // Wilson's score interval, which is honest where no trial or every one had it
};

// `events` of `count`, at most all.
ShareEstimate estimate_share(std::size_t events, std::size_t count);
// The share of the values that are not 0.
ShareEstimate estimate_share(std::span<const double> values);

// Quantile: the value below which a share of all values of a quantity lies.
struct QuantileEstimate {
  std::size_t count = 0;
  double value = 0.0;  // the smallest that at least 1 - share of the values reach; not a number without any
  Interval
      confidence_95;  // from ranks by the binomial law; at most the extremes, which few values do not earn
};

QuantileEstimate estimate_quantile(std::span<const double> values, double share);

// With fewer values than this the 5 % quantile is the smallest value, and a report may not say "95 of 100".
inline constexpr std::size_t kEnoughFor95Of100 = 20;

}  // namespace koboshi::lab
