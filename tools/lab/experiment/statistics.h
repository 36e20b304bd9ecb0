#pragma once

#include <cstddef>
#include <span>

namespace koboshi::tools {

struct Interval {
  double low = 0.0;
  double high = 0.0;

  double half_width() const { return 0.5 * (high - low); }
  friend bool operator==(const Interval&, const Interval&) = default;
};

// Of independent values of a quantity. Not a number: the mean of no value, and the deviation and interval of
// fewer than two.
struct MeanEstimate {
  std::size_t count = 0;
  double mean = 0.0;
  double standard_deviation = 0.0;  // of the values, with n - 1
  Interval confidence_95;           // of the mean, by Student's t
};

MeanEstimate estimate_mean(std::span<const double> values);

// Of independent trials that had an event or not.
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

// The value below which a share of all values of a quantity lies.
struct QuantileEstimate {
  std::size_t count = 0;
  double value = 0.0;  // the smallest that at least 1 - share of the values reach; not a number without any
  Interval
      confidence_95;  // from ranks by the binomial law; at most the extremes, which few values do not earn
};

QuantileEstimate estimate_quantile(std::span<const double> values, double share);

// Of fewer values than this the weakest is what the 5 % quantile is taken from, and no "95 of 100" may be
// said.
inline constexpr std::size_t kEnoughFor95Of100 = 20;

}  // namespace koboshi::tools
