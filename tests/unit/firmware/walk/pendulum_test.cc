#include "firmware/walk/pendulum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "firmware/fixed/host/convert.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::walk {
namespace {

using fixed::from_double;
using fixed::Length;
using fixed::to_double;
using test::kTickLength_s;

constexpr double kGravity_m_per_s2 = 9.80665;

double omega_per_s(double height_m) { return std::sqrt(kGravity_m_per_s2 / height_m); }

// One axis of the pendulum in double, from its closed form: equation 3 of the paper.
struct Reference {
  double x_m;
  double v_m_per_s;

  void advance(double zmp_m, double omega, double time_s) {
    const double from_zmp_m = x_m - zmp_m;
    const double c = std::cosh(omega * time_s);
    const double s = std::sinh(omega * time_s);
    x_m = zmp_m + from_zmp_m * c + v_m_per_s / omega * s;
    v_m_per_s = from_zmp_m * omega * s + v_m_per_s * c;
  }
};

Reference reference(Length dcm, Length ccm, double omega) {
  const double xi_m = to_double(dcm);
  const double zeta_m = to_double(ccm);
  return {(xi_m + zeta_m) / 2, omega * (xi_m - zeta_m) / 2};
}

class Draw {
 public:
  double uniform(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  Point point(double most_m) {
    return {from_double<Length>(uniform(-most_m, most_m)), from_double<Length>(uniform(-most_m, most_m))};
  }

 private:
  std::mt19937 random_{20081};
};

// Returns the largest deviation from the closed form after `ticks`, with the ZMP constant during each tick.
double worst_m(double lowest_m, double highest_m, int ticks) {
  Draw draw;
  double worst = 0.0;
  for (int round = 0; round < 2'000; ++round) {
    const Length height = from_double<Length>(draw.uniform(lowest_m, highest_m));
    const double omega = omega_per_s(to_double(height));
    const Pendulum pendulum(height);
    PendulumState state{draw.point(0.05), draw.point(0.05)};
    Reference x = reference(state.dcm.x, state.ccm.x, omega);
    Reference y = reference(state.dcm.y, state.ccm.y, omega);
    for (int tick = 0; tick < ticks; ++tick) {
      const Point zmp = draw.point(0.05);
      pendulum.advance(state, zmp);
      x.advance(to_double(zmp.x), omega, kTickLength_s);
      y.advance(to_double(zmp.y), omega, kTickLength_s);
    }
    worst = std::max({worst, std::abs(to_double(state.position().x) - x.x_m),
                      std::abs(to_double(state.position().y) - y.x_m)});
  }
  return worst;
}

TEST(Pendulum, FollowsTheClosedFormForATick) {
  const double worst = worst_m(0.05, 1.0, 1);
  EXPECT_LT(worst, 0.1e-6);
  EXPECT_GT(worst, 1e-9);
}

// A step of the default gait, during which an initial error grows sevenfold.
TEST(Pendulum, FollowsTheClosedFormForAStep) {
  const double worst = worst_m(0.15, 0.2, 26);
  EXPECT_LT(worst, 2e-6);
  EXPECT_GT(worst, 1e-8);
}

TEST(Pendulum, MovesLinearlyLikeItsZmp) {
  const Pendulum pendulum(from_double<Length>(0.17));
  const Point zmp{from_double<Length>(0.03), from_double<Length>(-0.02)};
  PendulumState state = PendulumState::at_rest(zmp);
  for (int tick = 0; tick < 1'000; ++tick) pendulum.advance(state, zmp);
  EXPECT_EQ(state.position(), zmp);
}

TEST(Pendulum, ComputesItsTimeConstantAndGrowth) {
  double worst = 0.0;
  for (double height_m = 0.05; height_m <= 1.0; height_m += 0.01) {
    const Pendulum pendulum(from_double<Length>(height_m));
    const double omega = omega_per_s(height_m);
    EXPECT_NEAR(to_double(pendulum.time_constant_s()), 1.0 / omega, 1e-7);
    for (std::size_t ticks = 0; ticks <= Pendulum::kMaxTicks; ++ticks) {
      const double expected = std::exp(omega * kTickLength_s * static_cast<double>(ticks));
      worst = std::max(worst, std::abs(to_double(pendulum.growth(ticks)) / expected - 1.0));
    }
  }
  EXPECT_LT(worst, 1e-4);
  EXPECT_GT(worst, 1e-7);
}

TEST(Pendulum, ClampsHeightsToItsBounds) {
  EXPECT_EQ(Pendulum(Length()).time_constant_s(), Pendulum(from_double<Length>(0.05)).time_constant_s());
  EXPECT_EQ(Pendulum(Length::max()).time_constant_s(), Pendulum(from_double<Length>(1.0)).time_constant_s());
}

TEST(PendulumLag, IsTheSumOfTheMissingParts) {
  for (const double height_m : {0.05, 0.17, 0.5}) {
    const Pendulum pendulum(from_double<Length>(height_m));
    const double growth = std::exp(omega_per_s(height_m) * kTickLength_s);
    for (std::int32_t ticks = 0; ticks <= 30; ++ticks) {
      double sum = 0.0;
      for (std::int32_t k = 1; k <= ticks; ++k) {
        sum += (1.0 - static_cast<double>(k) / (ticks + 1)) * (growth - 1.0) * std::pow(growth, -k);
      }
      EXPECT_NEAR(to_double(pendulum.lag(ticks)), sum, 1e-7) << height_m << " m, " << ticks << " ticks";
    }
  }
}

// Purpose of the lag: a ZMP that ramps over several cycles gives the same final DCM as a ZMP step from an
// offset initial state.
TEST(PendulumLag, RepresentsADelayedZmp) {
  const Pendulum pendulum(from_double<Length>(0.17));
  const Length way = from_double<Length>(0.06);
  const Length begin = from_double<Length>(0.025);
  for (const std::int32_t ticks : {0, 1, 4, 12}) {
    PendulumState slow = PendulumState::at_rest({begin, {}});
    PendulumState at_once =
        PendulumState::at_rest({begin + fixed::product<Length>(way, pendulum.lag(ticks)), {}});
    for (std::int32_t tick = 1; tick <= 26; ++tick) {
      const Length come = tick > ticks ? way : way * tick / (ticks + 1);
      pendulum.advance(slow, {come, {}});
      pendulum.advance(at_once, {way, {}});
    }
    EXPECT_NEAR(to_double(slow.dcm.x), to_double(at_once.dcm.x), 3e-6) << ticks << " ticks";
  }
}

}  // namespace
}  // namespace koboshi::walk
