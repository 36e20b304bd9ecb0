#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mechanics/hinge_tree.h"
#include "sim_board/description/description.h"
#include "sim_board/state/archive.h"
#include "sim_board/world/world.h"
#include "simulation/observe/telemetry.h"

namespace koboshi::simulation {

// Two links of the robot that touch each other.
struct SelfContact {
  int link = -1;
  int other_link = -1;               // > link
  std::uint64_t duration_us = 0;     // in all, not necessarily without interruption
  int joint = -1;                    // between the links, the one that is furthest from its target
  double following_error_rad = 0.0;  // of this joint at the last tick of the contact: position minus target
};

// Watches for links that touch each other. One link may stop another short of
// its target; the joint between them then has a constant following error, which nothing on the bus explains.
class SelfContacts {
 public:
  // A contact that has lasted this long in all is reported. Shorter ones, such as a hand that brushes the
  // trunk, do not disturb a posture.
  static constexpr std::uint64_t kReported_us = 300'000;

  explicit SelfContacts(const sim_board::RobotDescription& robot);

  // Observes a tick of kTick_us, in a state in which links should not touch. Returns a contact that has now
  // lasted kReported_us, once for each pair of links.
  std::optional<SelfContact> observe(const sim_board::World& world, const Telemetry& said);
  void archive(sim_board::StateArchive& archive);

 private:
  void find_obstructed_joint(SelfContact& contact, const Telemetry& said) const;

  mechanics::HingeTree tree_;
  std::vector<SelfContact> contacts_;  // all pairs that have touched
};

}  // namespace koboshi::simulation
