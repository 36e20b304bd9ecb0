#include <cmath>
#include <numbers>

#include "lab/validate/rigs.h"
#include "lab/validate/validation.h"
#include "tools/plot/legend.h"

namespace koboshi::lab {
namespace {

constexpr double kFriction_Nm = 0.0275;  // of the default servo
constexpr double kDamping_Nm_s = 0.01;
constexpr HangingLink kFrictionLink{.mass_kg = 0.2, .inertia_kg_m2 = 1e-3, .arm_m = 0.1};
constexpr double kInertia =
    kFrictionLink.inertia_kg_m2 + kFrictionLink.mass_kg * kFrictionLink.arm_m * kFrictionLink.arm_m;
constexpr double kWeight_Nm =
    kFrictionLink.mass_kg * kGravity_m_per_s2 * kFrictionLink.arm_m;  // the spring: m g r sin q
constexpr double kAmplitude_Nm = 0.12;
constexpr double kPeriod_s = 20.0;
constexpr double kFrequency = 2.0 * std::numbers::pi / kPeriod_s;

double torque_Nm(double time_s) { return kAmplitude_Nm * std::sin(kFrequency * time_s); }

struct Loop {
  std::vector<double> time_s, position_rad, torque_Nm;
};

// One period from the first turning point, which is a quarter of a period after the start.
Loop go_around(const ValidationSetup& setup) {
  const auto world = hang(chain_rig({kFrictionLink}), {0.0}, setup);
  Loop loop;
  for (long i = steps_of(1.25 * kPeriod_s, *world); i > 0; --i) {
    const double torque = torque_Nm(world->time_s());
    world->set_servo(0, {.drive_Nm = torque, .damping_Nm_s = kDamping_Nm_s, .friction_Nm = kFriction_Nm});
    world->step();
    if (world->time_s() < 0.25 * kPeriod_s) continue;
    loop.time_s.push_back(world->time_s());
    loop.position_rad.push_back(world->joint(0).position_rad);
    loop.torque_Nm.push_back(torque);
  }
  return loop;
}

// The torque at which the link passes the bottom in this direction.
double torque_at_bottom_Nm(const Loop& loop, double direction) {
  for (std::size_t i = 1; i < loop.time_s.size(); ++i) {
    const double before = direction * loop.position_rad[i - 1], now = direction * loop.position_rad[i];
    if (before >= 0.0 || now < 0.0) continue;
    const double part = now / (now - before);
    return loop.torque_Nm[i] - part * (loop.torque_Nm[i] - loop.torque_Nm[i - 1]);
  }
  return std::nan("");
}

double area_J(const Loop& loop) {
  double area = 0.0;
  for (std::size_t i = 1; i < loop.time_s.size(); ++i) {
    area +=
        0.5 * (loop.torque_Nm[i] + loop.torque_Nm[i - 1]) * (loop.position_rad[i] - loop.position_rad[i - 1]);
  }
  return area;
}

void check_loop(const ValidationSetup& setup, Findings& findings) {
  const Loop loop = go_around(setup);
  const double h = setup.world.step_s;
  // Slow enough for the link to be in balance: m g r sin q = tau -+ (Kc + d w).
  const double turn_rad = std::asin((kAmplitude_Nm - kFriction_Nm) / kWeight_Nm);
  const double fastest = kAmplitude_Nm * kFrequency / kWeight_Nm;
  const double at_bottom =
      fastest * std::sqrt(1.0 - std::pow((kFriction_Nm + kDamping_Nm_s * fastest) / kAmplitude_Nm, 2));
  const double viscous_J = kDamping_Nm_s * std::numbers::pi * turn_rad * turn_rad * kFrequency;
  // Out of balance: the link's inertia; the swing into which it was let go, an eighth of a period before, and
  // which decays with d/(2 J); a torque that is a step old.
  const double swing_Nm = std::sqrt(kInertia * kWeight_Nm) * fastest;
  const double torque_off_Nm = kInertia * kFrequency * fastest + h * kAmplitude_Nm * kFrequency +
                               swing_Nm * std::exp(-kDamping_Nm_s / (2.0 * kInertia) * kPeriod_s / 8.0);
  findings.check("hysteresis: width at the bottom", "N m", 2.0 * (kFriction_Nm + kDamping_Nm_s * at_bottom),
                 torque_at_bottom_Nm(loop, 1.0) - torque_at_bottom_Nm(loop, -1.0), 2.0 * torque_off_Nm);
  findings.check("hysteresis: area", "J", 4.0 * kFriction_Nm * turn_rad + viscous_J, area_J(loop),
                 4.0 * turn_rad * torque_off_Nm + 0.5 * viscous_J);
  std::vector<double> upper, lower;
  for (const double position_rad : loop.position_rad) {
    upper.push_back(kWeight_Nm * std::sin(position_rad) + kFriction_Nm);
    lower.push_back(kWeight_Nm * std::sin(position_rad) - kFriction_Nm);
  }
  findings.plots.push_back(
      {.name = "friction",
       .caption = "A link that hangs in gravity, driven slowly to and fro: it moves along m g r sin q +- Kc "
                  "(dashed) "
                  "and stands still while the torque crosses from one to the other.",
       .columns = {{"position_rad", loop.position_rad},
                   {"torque_Nm", loop.torque_Nm},
                   {"upper_Nm", upper},
                   {"lower_Nm", lower}},
       .figure = {.title = "Hysteresis of dry friction, Kc = 0.0275 N m",
                  .panels = {{.y_label = "drive torque [N m]",
                              .series = {tools::series(tools::Role::kTrue, "torque_Nm", "simulated"),
                                         tools::series(tools::Role::kTheory, "upper_Nm", "m g r sin q +- Kc"),
                                         tools::series(tools::Role::kTheory, "lower_Nm", "")}}},
                  .x_column = "position_rad",
                  .x_label = "joint angle [rad]"}});
}

// Checks that friction holds the joint against a torque below Kc.
void check_rest(double part, const ValidationSetup& setup, Findings& findings, const std::string& quantity) {
  ValidationSetup weightless = setup;
  weightless.world.gravity_W_m_per_s2.setZero();
  const auto world = hang(chain_rig({kFrictionLink}), {0.0}, weightless);
  world->set_servo(0, {.drive_Nm = part * kFriction_Nm, .friction_Nm = kFriction_Nm});
  const double duration_s = setup.short_form ? 1.0 : 5.0;
  run_for(*world, duration_s);
  constexpr double kEncoderCount_rad = 2.0 * std::numbers::pi / 4096;
  findings.check(quantity, "rad/s", 0.0, world->joint(0).position_rad / duration_s,
                 kEncoderCount_rad / 3600.0);
}

// Checks that the joint breaks away at Kc under a rising torque.
void check_break_away(const ValidationSetup& setup, Findings& findings) {
  constexpr double kRise_Nm_per_s = 0.05;
  constexpr double kNoticed_rad = 1e-5;
  ValidationSetup weightless = setup;
  weightless.world.gravity_W_m_per_s2.setZero();
  const auto world = hang(chain_rig({kFrictionLink}), {0.0}, weightless);
  double torque = 0.0;
  while (world->joint(0).position_rad < kNoticed_rad && torque < 2.0 * kFriction_Nm) {
    torque = kRise_Nm_per_s * world->time_s();
    world->set_servo(0, {.drive_Nm = torque, .friction_Nm = kFriction_Nm});
    world->step();
  }
  // q = rise t^3/(6 J) from Kc on; each step acts a step late, and comes up to a step late to the mark.
  const double noticed_s = std::cbrt(6.0 * kInertia * kNoticed_rad / kRise_Nm_per_s);
  findings.check("break-away: torque when moved by 1e-5 rad", "N m",
                 kFriction_Nm + kRise_Nm_per_s * noticed_s, torque,
                 kRise_Nm_per_s * 2.0 * setup.world.step_s);
}

Findings run_friction_loop(const ValidationSetup& setup) {
  Findings findings;
  check_loop(setup, findings);
  check_break_away(setup, findings);
  check_rest(0.9, setup, findings, "creep under 0.9 Kc");
  check_rest(0.99, setup, findings, "creep under 0.99 Kc");
  return findings;
}

}  // namespace

Validation friction_loop() {
  return {
      .name = "friction",
      .title = "Dry friction of a joint",
      .theory =
          "Coulomb with true stiction: a link whose weight makes m g r = 0.196 N m, driven by 0.12 N m to "
          "and fro once in 20 s, moves along m g r sin q +- (Kc + d w), Kc = 0.0275 N m, d = 0.01 N m s. "
          "The loop is 2 (Kc + d w) wide and its area 4 Kc q_max and what d takes, sin q_max = (0.12 N m - "
          "Kc)/(m g r). Under less than Kc a joint at rest stays. It lets go at Kc: under a torque that "
          "rises by "
          "0.05 N m/s it has moved by q = rise t^3/(6 J) after t.",
      .tolerances =
          "How far the link is out of balance at most: its inertia, what is left of the swing into "
          "which it was let go, a torque that is a step old; of the area, half of what d takes, which is "
          "known for a sine only. Rest: one count of the encoder in an hour. Break-away: by how much the "
          "torque "
          "rises in two steps.",
      .run = run_friction_loop};
}

}  // namespace koboshi::lab
