#include "sim_board/sensor/noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "sim_board/sensor/channel.h"

namespace koboshi::sim_board {
namespace {

constexpr double kPeriod_s = 0.01;

// A record of three axes as their running integral, from which the overlapping Allan deviation is taken.
class Record {
 public:
  Record(std::size_t samples, double period_s, const std::function<Eigen::Vector3d()>& sample)
      : period_s_(period_s) {
    integral_.reserve(samples + 1);
    integral_.push_back(Eigen::Vector3d::Zero());
    for (std::size_t i = 0; i < samples; ++i) integral_.push_back(integral_.back() + period_s * sample());
  }

  double points() const { return static_cast<double>(integral_.size()); }
  std::size_t averaged(double tau_s) const {
    return static_cast<std::size_t>(std::llround(tau_s / period_s_));
  }

  // The root of the mean of the three axes' variances (NIST Special Publication 1065, equation 11).
  double allan_deviation(double tau_s) const {
    const std::size_t m = averaged(tau_s);
    double sum = 0.0;
    for (std::size_t i = 0; i + 2 * m < integral_.size(); ++i) {
      sum += (integral_[i + 2 * m] - 2.0 * integral_[i + m] + integral_[i]).squaredNorm() / 3.0;
    }
    return std::sqrt(sum / (2.0 * tau_s * tau_s * static_cast<double>(integral_.size() - 2 * m)));
  }

 private:
  double period_s_;
  std::vector<Eigen::Vector3d> integral_;
};

// Four relative standard deviations of an Allan deviation over three axes: 4 / sqrt(2 * 3 * edf), with the
// equivalent degrees of freedom of NIST Special Publication 1065, table 5, for m samples of N.
double four_sigma(double degrees_of_freedom) { return 4.0 / std::sqrt(6.0 * degrees_of_freedom); }

double white_tolerance(double N, double m) {
  return four_sigma((1.5 * (N - 1.0) / m - 2.0 * (N - 2.0) / N) * 4.0 * m * m / (4.0 * m * m + 5.0));
}

double flicker_tolerance(double N, double m) { return four_sigma(5.0 * N * N / (4.0 * m * (N + 3.0 * m))); }

double walk_tolerance(double N, double m) {
  const double intervals = (N - 1.0) * (N - 1.0) - 3.0 * m * (N - 1.0) + 4.0 * m * m;
  return four_sigma((N - 2.0) / m * intervals / ((N - 3.0) * (N - 3.0)));
}

// The Allan variance of a first-order Gauss-Markov process (IEEE Std 952-1997, annex C.1.5).
double process_allan_variance(double sigma, double correlation_s, double tau_s) {
  const double x = tau_s / correlation_s;
  return 2.0 * sigma * sigma / x * (1.0 - (3.0 - 4.0 * std::exp(-x) + std::exp(-2.0 * x)) / (2.0 * x));
}

TEST(WhiteNoise, HasAnAllanDeviationThatFallsWithTheRootOfTime) {
  constexpr double kDensity = 0.004;
  WhiteNoise noise(kDensity, kPeriod_s, 3, "gyro");
  const Record record(500'000, kPeriod_s, [&] { return noise.sample(); });
  for (const double tau_s : {0.01, 0.1, 1.0, 10.0, 50.0}) {
    const double expected = kDensity / std::numbers::sqrt2 / std::sqrt(tau_s);
    const double tolerance = white_tolerance(record.points(), static_cast<double>(record.averaged(tau_s)));
    EXPECT_LT(tolerance, 0.16);
    EXPECT_NEAR(record.allan_deviation(tau_s) / expected, 1.0, tolerance) << tau_s;
  }
}

TEST(BiasInstability, IsFlatInTheory) {
  const double sigma = BiasInstability(1.0, kPeriod_s, 1, "gyro").sigma();
  for (double tau_s = 0.5; tau_s < 500.0; tau_s *= 1.2) {
    double variance = 0.0;
    double correlation_s = BiasInstability::kShortest_s;
    for (int i = 0; i < BiasInstability::kProcesses; ++i, correlation_s *= 10.0) {
      variance += process_allan_variance(sigma, correlation_s, tau_s);
    }
    EXPECT_NEAR(std::sqrt(variance), std::sqrt(2.0 * std::numbers::ln2 / std::numbers::pi), 0.03) << tau_s;
  }
}

TEST(BiasInstability, IsFlatInAllanDeviation) {
  constexpr double kCoefficient = 0.002;
  BiasInstability instability(kCoefficient, kPeriod_s, 5, "gyro");
  const Record record(2'000'000, kPeriod_s, [&] { return instability.sample(); });
  for (const double tau_s : {1.0, 3.0, 10.0, 30.0, 100.0}) {
    const double tolerance = flicker_tolerance(record.points(), static_cast<double>(record.averaged(tau_s)));
    EXPECT_LT(tolerance, 0.12);
    // The sum of five processes waves by 0.03 B about 0.664 B.
    EXPECT_NEAR(record.allan_deviation(tau_s) / (0.664 * kCoefficient), 1.0, tolerance + 0.045) << tau_s;
  }
}

TEST(BiasInstability, StartsInItsStationaryDistribution) {
  double early = 0.0;
  double late = 0.0;
  constexpr int kSeeds = 2000;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    BiasInstability instability(1.0, kPeriod_s, seed, "gyro");
    early += instability.sample().squaredNorm() / (3.0 * kSeeds);
    for (int i = 0; i < 1000; ++i) instability.sample();
    late += instability.sample().squaredNorm() / (3.0 * kSeeds);
  }
  const double variance = BiasInstability::kProcesses * std::numbers::ln10 / std::numbers::pi;
  const double four_sigma_of_variance = 4.0 * std::sqrt(2.0 / (3.0 * kSeeds));
  EXPECT_NEAR(early / variance, 1.0, four_sigma_of_variance);
  EXPECT_NEAR(late / variance, 1.0, four_sigma_of_variance);
}

TEST(RandomWalk, HasAnAllanDeviationThatRisesWithTheRootOfTime) {
  constexpr double kCoefficient = 0.0003;
  RandomWalk walk(kCoefficient, kPeriod_s, 7, "gyro");
  const Record record(1'000'000, kPeriod_s, [&] { return walk.sample(); });
  for (const double tau_s : {1.0, 3.0, 10.0, 30.0, 100.0}) {
    const double tolerance = walk_tolerance(record.points(), static_cast<double>(record.averaged(tau_s)));
    EXPECT_LT(tolerance, 0.18);
    EXPECT_NEAR(record.allan_deviation(tau_s) / (kCoefficient * std::sqrt(tau_s / 3.0)), 1.0, tolerance)
        << tau_s;
  }
}

TEST(RandomWalk, SpreadsWithTheRootOfTimeFromZero) {
  constexpr double kCoefficient = 2.0;
  constexpr int kSeeds = 2000;
  double square = 0.0;
  double fourth = 0.0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    RandomWalk walk(kCoefficient, kPeriod_s, seed, "gyro");
    for (int i = 0; i < 399; ++i) walk.sample();
    const Eigen::Array3d x = walk.sample() / (kCoefficient * std::sqrt(400 * kPeriod_s));
    square += x.square().sum() / (3.0 * kSeeds);
    fourth += x.pow(4).sum() / (3.0 * kSeeds);
  }
  EXPECT_NEAR(square, 1.0, 4.0 * std::sqrt(2.0 / (3.0 * kSeeds)));
  EXPECT_NEAR(fourth, 3.0, 4.0 * std::sqrt(96.0 / (3.0 * kSeeds)));  // normal
}

// All the way to counts: each of the three rules where it is larger than the others.
TEST(Channel, HasTheAllanDeviationOfItsThreeCoefficients) {
  ChannelDescription description;
  description.noise_density = 0.002;
  description.bias_instability = 0.003;
  description.random_walk = 0.0005;
  description.range = 10.0;
  description.resolution = 0.0005;
  description.sample_period_s = kPeriod_s;
  Channel channel(description, "gyro", {.seed = 11});
  const Record record(2'000'000, kPeriod_s, [&] {
    const std::array<std::int16_t, 3> counts = channel.sample();
    return Eigen::Vector3d(description.resolution * Eigen::Vector3d(counts[0], counts[1], counts[2]));
  });
  for (const double tau_s : {0.02, 0.1, 1.0, 5.0, 20.0, 100.0}) {
    const double white = description.noise_density * description.noise_density / (2.0 * tau_s) +
                         description.resolution * description.resolution / 12.0 * kPeriod_s / tau_s;
    double flicker = 0.0;
    double correlation_s = BiasInstability::kShortest_s;
    const double sigma = description.bias_instability * std::sqrt(std::numbers::ln10 / std::numbers::pi);
    for (int i = 0; i < BiasInstability::kProcesses; ++i, correlation_s *= 10.0) {
      flicker += process_allan_variance(sigma, correlation_s, tau_s);
    }
    const double walk = description.random_walk * description.random_walk * tau_s / 3.0;
    const double expected = std::sqrt(white + flicker + walk);
    // That of the random walk is the widest of the three.
    const double tolerance = walk_tolerance(record.points(), static_cast<double>(record.averaged(tau_s)));
    EXPECT_NEAR(record.allan_deviation(tau_s) / expected, 1.0, tolerance + 0.02) << tau_s;
  }
}

TEST(Drift, IsReproducibleAndDiffersByAxisSeedAndName) {
  BiasInstability a(1.0, 0.001, 1, "gyro");
  BiasInstability b(1.0, 0.001, 1, "gyro");
  BiasInstability seed(1.0, 0.001, 2, "gyro");
  BiasInstability name(1.0, 0.001, 1, "accelerometer");
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d value = a.sample();
    ASSERT_EQ(value, b.sample());
    ASSERT_NE(value.x(), value.y());
    ASSERT_NE(value.x(), seed.sample().x());
    ASSERT_NE(value.x(), name.sample().x());
  }
}

TEST(Drift, IsZeroWithZeroCoefficients) {
  BiasInstability instability(0.0, 0.001, 1, "gyro");
  RandomWalk walk(0.0, 0.001, 1, "gyro");
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(instability.sample(), Eigen::Vector3d::Zero());
    EXPECT_EQ(walk.sample(), Eigen::Vector3d::Zero());
  }
}

}  // namespace
}  // namespace koboshi::sim_board
