#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace koboshi::lab {

// Frequency response of a feedback loop, measured where it is closed. A sine d is added to a signal w of the
// loop, and the loop continues with m = w + d. All that comes back to w has gone once around, so that
//
//   L(f) = - W(f) / M(f)
//
// is the open loop's response, with the sign of negative feedback, whatever the closed loop does (R. D.
// Middlebrook, "Measurement of loop gain in feedback systems", 1975).

// Fourier component of samples at one frequency, over whole periods: a constant does not count, nor does a
// sine that has whole periods in the same time.
class SineCorrelator {
 public:
  explicit SineCorrelator(double frequency_Hz) : frequency_Hz_(frequency_Hz) {}

  void add(double time_s, double value);
  // The complex amplitude A of A exp(i 2 pi f t); 0 without samples.
  std::complex<double> amplitude() const;

 private:
  double frequency_Hz_;
  std::complex<double> sum_{};
  std::size_t count_ = 0;
};

struct LoopPoint {
  double frequency_Hz = 0.0;
  std::complex<double> gain{};  // L
};

// Phases in degrees, continuous over the points, from that of the first in -270 .. 90.
[[nodiscard]] std::vector<double> unwrapped_phases_deg(std::span<const LoopPoint> points);

// Stability margins, interpolated between points in the logarithms of gain and frequency.
struct LoopMargins {
  std::optional<double> crossover_Hz{};        // the highest frequency at which the gain falls below 1
  std::optional<double> phase_margin_deg{};    // 180 degrees plus the phase there, within half a turn
  std::optional<double> phase_crossover_Hz{};  // where the phase falls through -180 degrees; of several, the
                                               // one with the highest gain
  std::optional<double> gain_margin{};         // 1 over the gain there
  double distance = 0.0;                       // the least distance of a point from -1
};

// `points` by rising frequency; two or more.
[[nodiscard]] LoopMargins margins_of(std::span<const LoopPoint> points);

}  // namespace koboshi::lab
