#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "lab/validate/validation.h"
#include "sim_board/description/description.h"
#include "sim_board/world/gravity.h"
#include "sim_board/world/world.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::lab {

// The mechanisms of the validations, built in code.

using sim_board::kGravity_m_per_s2;

// One free box of uniform density, its frame in the middle.
[[nodiscard]] sim_board::RobotDescription box_rig(double mass_kg, const Eigen::Vector3d& size_m,
                                                  const sim_board::SurfaceDescription& surface = {});
// The moments of inertia of this box about its axes.
[[nodiscard]] Eigen::Vector3d box_moments_kg_m2(double mass_kg, const Eigen::Vector3d& size_m);

// A link that hangs straight down from its hinge when the joint is at zero; the inertia about its centre of
// mass is the same in all directions.
struct HangingLink {
  double mass_kg = 0.2;
  double inertia_kg_m2 = 1e-3;
  double arm_m = 0.1;     // from the hinge to the centre of mass
  double length_m = 0.2;  // from the hinge to the next link's
};
// A chain of hanging links below a bearing, hinged about y. The bearing needs WorldOptions::fixed_base.
[[nodiscard]] sim_board::RobotDescription chain_rig(const std::vector<HangingLink>& links);

// A world without ground whose bearing is held, its joints at these positions.
[[nodiscard]] std::unique_ptr<sim_board::World> hang(const sim_board::RobotDescription& chain,
                                                     const std::vector<double>& positions_rad,
                                                     const ValidationSetup& setup);

[[nodiscard]] long steps_of(double duration_s, const sim_board::World& world);
void run_for(sim_board::World& world, double duration_s);

// Squats of the whole robot, earlier than in the scenario's file: enabled at 0.7 s, released at 1.4 s,
// commanded to play at 1.5 s. The robot moves down from 3.5 s to 4.5 s.
inline constexpr std::uint64_t kSquatBegins_us = 3'500'000;

// Throws InputError if the setup's scenario has no motion.
[[nodiscard]] simulation::Scenario squat_scenario(const ValidationSetup& setup);

}  // namespace koboshi::lab
