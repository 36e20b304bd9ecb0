#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lab/validate/rigs.h"
#include "lab/validate/theory.h"
#include "lab/validate/validation.h"
#include "sim_board/engine/make_world.h"
#include "tools/plot/legend.h"

namespace koboshi::lab {
namespace {

using Eigen::Vector3d;

const Moments kMoments(1e-3, 2e-3, 3e-3);
constexpr double kRate = 10.0;  // rad/s about the axis in question

// A weightless body that a couple in the first step spins up to `w`.
std::unique_ptr<sim_board::World> spun(const Vector3d& w, const ValidationSetup& setup) {
  sim_board::RobotDescription robot = box_rig(1.0, {0.1, 0.1, 0.1});
  robot.links[0].I_LCom_L = kMoments.asDiagonal();
  sim_board::WorldOptions options = setup.world;
  options.ground.present = false;
  options.gravity_W_m_per_s2.setZero();
  auto world = sim_board::make_world(robot, options);
  const Vector3d torque = kMoments.cwiseProduct(w) / options.step_s;
  // Each axis by two forces at levers of half a metre.
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d lever = 0.5 * Vector3d::Unit((axis + 1) % 3);
    const Vector3d force = torque[axis] * Vector3d::Unit((axis + 2) % 3);
    world->push(0, lever, force);
    world->push(0, -lever, -force);
  }
  world->step();
  return world;
}

Vector3d rate_in_body(const sim_board::World& world) {
  const sim_board::BodyState body = world.body(0);
  return body.X_WL.linear().transpose() * body.w_WL_W;
}

Vector3d momentum_in_world(const sim_board::World& world) {
  return world.body(0).X_WL.linear() * kMoments.cwiseProduct(rate_in_body(world));
}

// Bounds of the drift of a first-order method, along the true motion: of the energy (h/2) int w' I w' dt, of
// the momentum's magnitude (h/2) int |L'|^2/L dt, of its vector (h/2) int |w| |L'| dt, with L' in the body's
// frame. Calls `each` with the rate at each time.
struct Drift {
  double energy_J = 0.0;
  double momentum = 0.0;
  double momentum_vector = 0.0;
};
template <typename Each>
Drift drift_along(Vector3d w, double duration_s, double step_s, const Each& each) {
  constexpr double kFine_s = 1e-4;
  Drift drift;
  const double momentum = std::sqrt(constants_of(kMoments, w).momentum_squared);
  for (long i = std::lround(duration_s / kFine_s); i > 0; --i) {
    const Vector3d rate = euler_rate(kMoments, w);
    drift.energy_J += 0.5 * step_s * kFine_s * kMoments.dot(rate.cwiseAbs2());
    drift.momentum += 0.5 * step_s * kFine_s * kMoments.cwiseProduct(rate).squaredNorm() / momentum;
    drift.momentum_vector += 0.5 * step_s * kFine_s * w.norm() * kMoments.cwiseProduct(rate).norm();
    w = runge_kutta_step(w, kFine_s, [](const Vector3d& y) { return euler_rate(kMoments, y); });
    each(w);
  }
  return drift;
}

// Bound of the error of the flip's time from the drift of the constants.
double flip_tolerance_s(const FreeBodyConstants& constants, const Drift& drift) {
  const double exact_s = flip_time_s(kMoments, constants);
  double most_s = 0.0;
  for (const double energy_sign : {-1.0, 1.0}) {
    for (const double momentum_sign : {-1.0, 1.0}) {
      const double momentum = std::sqrt(constants.momentum_squared) + momentum_sign * drift.momentum;
      const double off_s =
          flip_time_s(kMoments, {constants.energy_J + energy_sign * drift.energy_J, momentum * momentum});
      most_s = std::max(most_s, std::abs(off_s - exact_s));
    }
  }
  return most_s;
}

void check_flips(const ValidationSetup& setup, Findings& findings) {
  const Vector3d start(0.0, kRate, 1.0);
  const double h = setup.world.step_s;
  const FreeBodyConstants constants = constants_of(kMoments, start);
  const double flip_s = flip_time_s(kMoments, constants);
  const int flips = 3;
  const double duration_s = flips * flip_s;
  std::vector<double> theory;
  static_cast<void>(drift_along(start, duration_s, h, [&](const Vector3d& w) { theory.push_back(w[1]); }));

  const auto world = spun(start, setup);
  const Vector3d momentum_start = momentum_in_world(*world);
  std::vector<double> time_s, simulated, exact, passages_s;
  FreeBodyConstants at_passage;
  Vector3d momentum_at_passage = Vector3d::Zero();
  double before = kRate;
  for (long i = steps_of(duration_s, *world); i > 0; --i) {
    world->step();
    const double now = rate_in_body(*world)[1];
    const double since_s = world->time_s() - h;  // it turned from the end of the first step on
    if (before * now < 0.0) {
      if (passages_s.empty()) {
        at_passage = constants_of(kMoments, rate_in_body(*world));
        momentum_at_passage = momentum_in_world(*world);
      }
      passages_s.push_back(since_s - h * now / (now - before));
    }
    before = now;
    time_s.push_back(since_s);
    simulated.push_back(now);
    const auto fine = static_cast<std::size_t>(std::lround(since_s / 1e-4));
    exact.push_back(theory[std::min(fine, theory.size()) - 1]);
  }
  passages_s.resize(flips, std::nan(""));
  for (int n = 0; n < flips; ++n) {
    const double theory_s = (n + 0.5) * flip_s;
    const Drift until = drift_along(start, theory_s, h, [](const Vector3d&) {});
    findings.check(fmt::format("intermediate axis: passage {}", n + 1), "s", theory_s,
                   passages_s[static_cast<std::size_t>(n)],
                   h + (n + 0.5) * flip_tolerance_s(constants, until));
  }
  // Until the first passage, simulated and true motion agree up to the next order, h w.
  const double momentum = std::sqrt(constants.momentum_squared);
  const double next_order = 1.0 + 10.0 * h * kRate;
  const Drift until = drift_along(start, 0.5 * flip_s, h, [](const Vector3d&) {});
  findings.check("intermediate axis: energy until passage 1, relative", "1", 0.0,
                 at_passage.energy_J / constants.energy_J - 1.0,
                 next_order * until.energy_J / constants.energy_J);
  findings.check("intermediate axis: angular momentum until passage 1, relative", "1", 0.0,
                 (momentum_at_passage - momentum_start).norm() / momentum,
                 next_order * until.momentum_vector / momentum);
  findings.plots.push_back(
      {.name = "tennis-racket",
       .caption =
           "The body turns steadily, then flips over, again and again. The first flip comes in time; then "
           "the energy and momentum that a step of 1 ms has lost and gained tell, and it flips sooner each "
           "time.",
       .columns = {{"time_s", time_s}, {"simulated", simulated}, {"theory", exact}},
       .figure = {.title = "Rotation about the intermediate axis, moments of inertia 1 : 2 : 3",
                  .panels = {{.y_label = "rate about the axis [rad/s]",
                              .series = {tools::series(tools::Role::kTrue, "simulated", "simulated"),
                                         tools::series(tools::Role::kTheory, "theory", "theory")}}}}});
}

// A small deviation from rotation about a stable axis moves on an ellipse. Its maximum is the semi-major
// axis.
void check_stable(int axis, const ValidationSetup& setup, Findings& findings) {
  constexpr double kDeviation = 0.1;  // rad/s
  const int other = axis == 0 ? 2 : 0;
  const double I = kMoments[axis], Io = kMoments[other], I2 = kMoments[1];
  Vector3d start = Vector3d::Zero();
  start[axis] = kRate;
  start[other] = kDeviation;
  const double across = kDeviation * std::sqrt(Io * (I - Io) / (I2 * (I - I2)));
  const double theory = std::max(kDeviation, across);
  const double nutation = kRate * std::sqrt((I - Io) * (I - I2) / (Io * I2));
  const double duration_s = setup.short_form ? 1.0 : 2.0;
  const auto world = spun(start, setup);
  double largest = 0.0;
  for (long i = steps_of(duration_s, *world); i > 0; --i) {
    world->step();
    Vector3d w = rate_in_body(*world);
    w[axis] = 0.0;
    largest = std::max(largest, w.norm());
  }
  // The drifts of energy and momentum act on L^2 - 2 E I, the sum of Ii (Ii - I) wi^2, together at most like
  // the sum of Ii (Ii + I) wi'^2.
  const double w_other = kDeviation * kDeviation, w_2 = across * across;
  const double amplified = (Io * (Io + I) * w_other + I2 * (I2 + I) * w_2) /
                           std::abs(Io * (Io - I) * w_other + I2 * (I2 - I) * w_2);
  const double growth = std::expm1(0.5 * setup.world.step_s * nutation * nutation * amplified * duration_s);
  findings.check(fmt::format("{} axis: largest deviation", axis == 0 ? "minor" : "major"), "rad/s", theory,
                 largest, theory * growth + 1e-4 * theory);
}

Findings run_tennis_racket(const ValidationSetup& setup) {
  Findings findings;
  check_flips(setup, findings);
  check_stable(0, setup, findings);
  check_stable(2, setup, findings);
  return findings;
}

}  // namespace

Validation tennis_racket() {
  return {.name = "tennis-racket",
          .title = "Tennis-racket theorem",
          .theory =
              "Euler's equations of a free body with moments of inertia 1, 2 and 3 g m^2. Begun at 10 rad/s "
              "about the intermediate axis and 1 rad/s about the major one, w2 passes zero each 2 K(k)/p "
              "(Landau and Lifshitz, Mechanics, section 37). About the minor and the major axis a deviation "
              "of 0.1 rad/s goes round an ellipse. Energy and angular momentum stay.",
          .tolerances =
              "A method of first order, explicit or linearly implicit, gains or loses the energy (h/2) int "
              "w' I w' dt and the momentum (h/2) int |L'|^2/L dt (as a vector (h/2) int |w| |L'| dt), here "
              "along the true motion, and a part 10 h w of the next order; the times may be off by what "
              "such constants do to 2 K/p. On L^2 - 2 E I, I the stable axis' moment, both drifts act "
              "together: a deviation of frequency n grows by exp(h n^2 t/2 sum Ii (Ii + I) wi^2 / sum Ii "
              "|Ii - I| wi^2) at most.",
          .run = run_tennis_racket};
}

}  // namespace koboshi::lab
