#include "lab/validate/rigs.h"
#include "lab/validate/validation.h"
#include "sim_board/engine/make_world.h"

namespace koboshi::lab {
namespace {

constexpr double kDuration_s = 0.5;
constexpr double kRoundOff = 1e-9;

sim_board::BodyState fallen(const ValidationSetup& setup) {
  sim_board::WorldOptions options = setup.world;
  options.ground.present = false;
  const auto world = sim_board::make_world(box_rig(0.7, {0.1, 0.2, 0.3}), options);
  run_for(*world, kDuration_s);
  return world->body(0);
}

double theory_m() { return -0.5 * kGravity_m_per_s2 * kDuration_s * kDuration_s; }

Findings run_free_fall(const ValidationSetup& setup) {
  const sim_board::BodyState body = fallen(setup);
  const double late_m = 0.5 * kGravity_m_per_s2 * setup.world.step_s * kDuration_s;
  return {
      .checks = {{"position after 0.5 s", "m", theory_m(), body.X_WL.translation().z(),
                  late_m * (1.0 + 1e-6) + kRoundOff},
                 {"speed after 0.5 s", "m/s", -kGravity_m_per_s2 * kDuration_s, body.v_WCom_W.z(), kRoundOff},
                 {"way aside", "m", 0.0, body.X_WL.translation().head<2>().norm(), kRoundOff}}};
}

}  // namespace

double free_fall_error_m(const ValidationSetup& setup) {
  return fallen(setup).X_WL.translation().z() - theory_m();
}

Validation free_fall() {
  return {.name = "free-fall",
          .title = "Free fall",
          .theory = "A box without ground, from rest: z = -g t^2/2, v = -g t, g = 9.80665 m/s^2.",
          .tolerances =
              "Semi-implicit Euler moves a body with the speed at the end of a step, so that it falls "
              "g h t/2 too far; its speed under a constant force is exact.",
          .run = run_free_fall};
}

}  // namespace koboshi::lab
