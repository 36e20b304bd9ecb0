#pragma once

#include <string>
#include <vector>

#include "lab/experiment/field_table.h"
#include "lab/trial/commanded_walk.h"
#include "lab/trial/contact_observer.h"
#include "lab/trial/outcome.h"
#include "sim_board/description/description.h"

namespace koboshi::lab {

// Whether the simulated contacts hold while the robot falls and rises: no surface sinks into another without
// a force, sliding contacts obey Coulomb's law, and links do not overlap.
//
// Two cells. drive-failure: a leg's drive loses its power in a walk, and the robot goes limp and falls. push:
// a standing robot is pushed over, falls with its protective motion, and gets up.
struct ContactsTrial {
  Outcome outcome = Outcome::kSurvived;
  std::string error{};
  ContactExtremes extremes{};
  std::uint64_t unsettled_steps = 0;      // in which sliding contacts did not settle
  double largest_overlap_m = 0.0;         // of links that collide
  std::vector<double> free_overlaps_m{};  // the largest of each pair of links that never collides
};
// The fields depend on the robot: each pair of links that never collides has one.
[[nodiscard]] FieldTable<ContactsTrial> contacts_fields(const sim_board::RobotDescription& robot);

// It concludes, over all cells, deepest_without_force_m, unsettled_share, largest_overlap_m, and the largest
// overlap of every pair that never collides. Throws InputError.
[[nodiscard]] Experiment make_contacts(const ExperimentSetup& setup);

}  // namespace koboshi::lab
