#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim_board/description/description.h"
#include "sim_board/world/world.h"

namespace koboshi::lab {

// Two links with collision shapes.
struct LinkPair {
  std::array<int, 2> links;
  bool collides;           // false: fewer than sim_board::kMinJointsBetween joints lie between them
  double overlap_m = 0.0;  // the largest so far, of any two of their boxes
};
[[nodiscard]] std::vector<LinkPair> link_pairs(const sim_board::RobotDescription& robot);

// The extremes of the contacts of a world.
struct ContactExtremes {
  std::uint64_t contact_steps = 0;       // observed with at least one contact
  double deepest_m = 0.0;                // of all contacts, with the ground too
  double deepest_without_force_m = 0.0;  // of contacts whose surfaces go on closing, and that feel no force
  double largest_force_N = 0.0;
};

// Observes whether the contacts of a world do what contacts must: bear a force where surfaces overlap, and
// keep links out of each other.
class ContactObserver {
 public:
  // Both must outlive the observer.
  ContactObserver(const sim_board::RobotDescription& robot, const sim_board::World& world);

  // After each step, or less often.
  void observe();

  const ContactExtremes& extremes() const { return extremes_; }
  const std::vector<LinkPair>& pairs() const { return pairs_; }

 private:
  void observe_contacts();
  void observe_pairs();
  double closing_m_per_s(const sim_board::Contact& contact) const;

  const sim_board::RobotDescription& robot_;
  const sim_board::World& world_;
  ContactExtremes extremes_;
  std::vector<LinkPair> pairs_;
};

}  // namespace koboshi::lab
