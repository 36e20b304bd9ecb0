#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lab/validate/rigs.h"
#include "lab/validate/validation.h"
#include "sim_board/engine/make_world.h"
#include "tools/plot/legend.h"

namespace koboshi::lab {
namespace {

constexpr double kRestitution = 0.7;
constexpr double kDrop_m = 0.5;
constexpr double kHalf_m = 0.05;  // of the cube

// The hardest surface of the engine. The coefficient of restitution does not depend on it, but the rest does.
sim_board::SurfaceDescription hard(double restitution) {
  sim_board::SurfaceDescription surface;
  surface.bounce = restitution;
  surface.constraint_force_mixing = 0.0;
  surface.friction = surface.friction_second = 0.0;
  return surface;
}

struct Flight {
  double impact_s = 0.0;   // when the impact began
  double highest_m = 0.0;  // above the ground
};

struct Trace {
  std::vector<double> time_s;
  std::vector<double> height_m;
  std::vector<Flight> flights;  // after each impact; the last is not over
};

Trace drop(const ValidationSetup& setup, int impacts) {
  sim_board::WorldOptions options = setup.world;
  options.ground.surface = hard(kRestitution);
  options.X_WB.translation().z() = kDrop_m + kHalf_m;
  const auto world = sim_board::make_world(
      box_rig(1.0, Eigen::Vector3d::Constant(2.0 * kHalf_m), hard(kRestitution)), options);
  Trace trace;
  double speed = 0.0;
  constexpr double kLongest_s = 5.0;
  const long most = steps_of(kLongest_s, *world);
  for (long i = 0; i < most && static_cast<int>(trace.flights.size()) <= impacts; ++i) {
    world->step();
    const sim_board::BodyState body = world->body(0);
    const double height_m = body.X_WL.translation().z() - kHalf_m;
    if (speed < 0.0 && body.v_WCom_W.z() > 0.0) trace.flights.push_back({world->time_s(), 0.0});
    speed = body.v_WCom_W.z();
    if (!trace.flights.empty()) {
      trace.flights.back().highest_m = std::max(trace.flights.back().highest_m, height_m);
    }
    trace.time_s.push_back(world->time_s());
    trace.height_m.push_back(height_m);
  }
  return trace;
}

// The height at a time, with ideal impacts.
double ideal_height_m(double time_s) {
  const double fall_s = std::sqrt(2.0 * kDrop_m / kGravity_m_per_s2);
  if (time_s < fall_s) return kDrop_m - 0.5 * kGravity_m_per_s2 * time_s * time_s;
  double since_s = time_s - fall_s;
  double speed = kRestitution * kGravity_m_per_s2 * fall_s;
  while (since_s > 2.0 * speed / kGravity_m_per_s2) {
    since_s -= 2.0 * speed / kGravity_m_per_s2;
    speed *= kRestitution;
  }
  return since_s * (speed - 0.5 * kGravity_m_per_s2 * since_s);
}

void check_bounces(const ValidationSetup& setup, Findings& findings) {
  const int impacts = setup.short_form ? 2 : 4;
  const double h = setup.world.step_s;
  const Trace trace = drop(setup, impacts);
  double speed = std::sqrt(2.0 * kGravity_m_per_s2 * kDrop_m);  // before the impact
  double speed_off = 0.0;                                       // its error bound by then
  double height_off = 0.0;
  for (int n = 1; n <= impacts; ++n) {
    // An impact is up to half a step early or late, g h/2 slower or faster and v h/2 off; these are bounds
    // for a whole step.
    speed_off = kRestitution * (speed_off + kGravity_m_per_s2 * h);
    height_off = kRestitution * kRestitution * (height_off + speed * h) + speed * h;
    speed *= kRestitution;
    height_off += 0.5 * speed * h;  // and semi-implicit Euler rises v h/2 less
    const bool over = trace.flights.size() > static_cast<std::size_t>(n);
    const auto flight = [&](int number) { return trace.flights[static_cast<std::size_t>(number)]; };
    findings.check(fmt::format("height of bounce {}", n), "m", speed * speed / (2.0 * kGravity_m_per_s2),
                   over ? flight(n - 1).highest_m : std::nan(""), height_off);
    findings.check(fmt::format("time from impact {} to {}", n, n + 1), "s", 2.0 * speed / kGravity_m_per_s2,
                   over ? flight(n).impact_s - flight(n - 1).impact_s : std::nan(""),
                   3.0 * h + 2.0 * speed_off / kGravity_m_per_s2);
  }
  std::vector<double> ideal_m;
  for (const double time_s : trace.time_s) ideal_m.push_back(ideal_height_m(time_s));
  findings.plots.push_back(
      {.name = "bounce",
       .caption = "Heights shrink by e^2 = 0.49 from bounce to bounce; the curves agree up to the half step "
                  "by which an impact is early or late.",
       .columns = {{"time_s", trace.time_s}, {"simulated_m", trace.height_m}, {"theory_m", ideal_m}},
       .figure = {.title = "A cube dropped from 0.5 m, restitution 0.7",
                  .panels = {{.y_label = "height [m]",
                              .series = {tools::series(tools::Role::kTrue, "simulated_m", "simulated"),
                                         tools::series(tools::Role::kTheory, "theory_m", "theory")}}}}});
}

// Drops a tilted rod without friction onto the edge of its lower end.
void check_edge(const ValidationSetup& setup, Findings& findings) {
  constexpr double kMass_kg = 0.5;
  constexpr double kTilt_rad = 0.5;
  constexpr double kFall_m = 0.2;
  constexpr double kEdgeRestitution = 0.6;
  const Eigen::Vector3d size_m(0.3, 0.05, 0.02);
  // About y by a positive angle the end at +x goes down.
  const Eigen::Matrix3d R = Eigen::AngleAxisd(kTilt_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Eigen::Vector3d p_edge = R * Eigen::Vector3d(0.5 * size_m.x(), 0.0, -0.5 * size_m.z());
  sim_board::WorldOptions options = setup.world;
  options.ground.surface = hard(kEdgeRestitution);
  options.X_WB.linear() = R;
  options.X_WB.translation().z() = kFall_m - p_edge.z();
  const auto world = sim_board::make_world(box_rig(kMass_kg, size_m, hard(kEdgeRestitution)), options);
  const double speed = std::sqrt(2.0 * kGravity_m_per_s2 * kFall_m);
  const double until_s = speed / kGravity_m_per_s2 + 3.0 * setup.world.step_s;
  while (world->body(0).w_WL_W.norm() == 0.0 && world->time_s() < until_s) world->step();
  const sim_board::BodyState body = world->body(0);

  // Poisson's and Newton's hypotheses agree without friction: j = (1 + e) v / (1/m + x^2/I).
  const double inertia = box_moments_kg_m2(kMass_kg, size_m).y();
  const double impulse_a_speed =
      (1.0 + kEdgeRestitution) / (1.0 / kMass_kg + p_edge.x() * p_edge.x() / inertia);
  // Up to a step late, and gravity of the impact's own step is taken up by the impulse.
  const double speed_off = kGravity_m_per_s2 * setup.world.step_s * (1.0 + 1.0 / (1.0 + kEdgeRestitution));
  findings.check("rod on its edge: speed after", "m/s", (impulse_a_speed / kMass_kg - 1.0) * speed,
                 body.v_WCom_W.z(), speed_off * (std::abs(impulse_a_speed / kMass_kg - 1.0) + 1.0));
  findings.check("rod on its edge: rate after", "rad/s", -impulse_a_speed * speed * p_edge.x() / inertia,
                 body.w_WL_W.y(), speed_off * impulse_a_speed * p_edge.x() / inertia);
}

Findings run_bounce(const ValidationSetup& setup) {
  Findings findings;
  check_bounces(setup, findings);
  check_edge(setup, findings);
  return findings;
}

}  // namespace

Validation bounce() {
  return {
      .name = "bounce",
      .title = "Impact and bounce",
      .theory =
          "Newton's law of restitution, v' = -e v: a cube of 0.1 m dropped from 0.5 m, e = 0.7, rises to "
          "e^(2n) 0.5 m, with 2 e^n v0/g between impacts. A rod of 0.5 kg, 0.3 m long and tilted by 0.5 "
          "rad, falls 0.2 m onto the edge of its end, e = 0.6, no friction: an impulse j = (1 + e) v / "
          "(1/m + x^2/I) at x from its centre. Surfaces as hard as the engine has them.",
      .tolerances =
          "An impact is up to half a step early or late: g h/2 slower or faster, and up to v h/2 above or "
          "below the ground; the bounds are those of a whole step. From bounce to bounce what this does to "
          "speed, height and time adds up. On the rod's edge gravity of the impact's own step is taken up by "
          "the impulse as well.",
      .run = run_bounce};
}

}  // namespace koboshi::lab
