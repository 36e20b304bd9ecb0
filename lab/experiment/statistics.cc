#include "lab/experiment/statistics.h"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace koboshi::lab {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kUpperQuantile = 0.975;  // a 95 % interval leaves 2.5 % on either side

}  // namespace

MeanEstimate estimate_mean(std::span<const double> values) {
  MeanEstimate estimate{values.size(), kNotANumber, kNotANumber, {kNotANumber, kNotANumber}};
  const double count = static_cast<double>(values.size());
  if (values.empty()) return estimate;
  estimate.mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  if (values.size() < 2) return estimate;
  double squares = 0.0;
  for (const double value : values) squares += (value - estimate.mean) * (value - estimate.mean);
  estimate.standard_deviation = std::sqrt(squares / (count - 1.0));
  const boost::math::students_t distribution(count - 1.0);
  const double half_width =
      boost::math::quantile(distribution, kUpperQuantile) * estimate.standard_deviation / std::sqrt(count);
  estimate.confidence_95 = {estimate.mean - half_width, estimate.mean + half_width};
  return estimate;
}

ShareEstimate estimate_share(std::size_t events, std::size_t count) {
  if (count == 0) return {0, 0, kNotANumber, {0.0, 1.0}};
  const double n = static_cast<double>(count);
  const double share = static_cast<double>(events) / n;
  // E. B. Wilson, "Probable inference, the law of succession, and statistical inference", 1927.
  const double z = boost::math::quantile(boost::math::normal(), kUpperQuantile);
  const double middle = (share + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double reach = z / (1.0 + z * z / n) * std::sqrt(share * (1.0 - share) / n + z * z / (4.0 * n * n));
  // Round-off must not leave the ends a hair within 0 and 1.
  const double low = events == 0 ? 0.0 : std::max(0.0, middle - reach);
  const double high = events == count ? 1.0 : std::min(1.0, middle + reach);
  return {count, events, share, {low, high}};
}

ShareEstimate estimate_share(std::span<const double> values) {
  const auto events = std::ranges::count_if(values, [](double value) { return value != 0.0; });
  return estimate_share(static_cast<std::size_t>(events), values.size());
}

QuantileEstimate estimate_quantile(std::span<const double> values, double share) {
  if (values.empty()) return {0, kNotANumber, {kNotANumber, kNotANumber}};
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);
  const auto at = [&](double rank) {
    return sorted[static_cast<std::size_t>(std::clamp(rank, 0.0, static_cast<double>(sorted.size() - 1)))];
  };
  // How many of the values lie below the quantile is binomial. From the lower rank to the upper one, counted
  // from 1, the quantile is with a probability of P(rank_low <= below < rank_high) (W. J. Conover, "Practical
  // nonparametric statistics", section 3.2). Boost rounds the number that 2.5 % do not exceed down, and the
  // one that 97.5 % do not exceed up.
  const double n = static_cast<double>(sorted.size());
  const boost::math::binomial below(n, share);
  return {sorted.size(),
          at(std::floor(share * n + 1e-9)),
          {at(std::floor(boost::math::quantile(below, 1.0 - kUpperQuantile))),
           at(std::ceil(boost::math::quantile(below, kUpperQuantile)))}};
}

}  // namespace koboshi::lab
