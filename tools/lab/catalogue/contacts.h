#pragma once

#include "tools/lab/experiment/report.h"
#include "tools/lab/trial/commanded_walk.h"

namespace koboshi::tools {

// Whether the simulated contacts hold while the robot falls and rises: no surface sinks into another without
// a force, contacts that slide obey Coulomb's law, and links stay out of each other.
//
// Two cells. drive-failure: a leg's drive loses its power in a walk, and the robot goes limp and falls. push:
// a standing robot is pushed over, falls with its protective motion, and gets up.
struct ContactsOptions : CommandedWalkOptions {};

// Throws sim::InputError.
[[nodiscard]] Experiment make_contacts(const ContactsOptions& options);

// Over all cells: deepest_without_force_m, unsettled_share, largest_overlap_m of links that collide, and the
// largest overlap of every pair that does not.
[[nodiscard]] Conclusions contacts_conclusions(const ContactsOptions& options,
                                               const ExperimentResult& result);

}  // namespace koboshi::tools
