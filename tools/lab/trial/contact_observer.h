#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim_board/robot/description.h"
#include "sim_board/world/world.h"

namespace koboshi::tools {

// Two links with collision shapes.
struct LinkPair {
  std::array<int, 2> links;
  bool collides;           // false: fewer than sim::kMinJointsBetween joints lie between them
  double overlap_m = 0.0;  // the largest so far, of any two of their boxes
};
[[nodiscard]] std::vector<LinkPair> link_pairs(const sim::RobotDescription& robot);

// Observes whether the contacts of a world do what contacts must: bear a force where surfaces overlap, and
// keep links out of each other.
class ContactObserver {
 public:
  // Both must outlive the observer.
  ContactObserver(const sim::RobotDescription& robot, const sim::World& world);

  // After each step, or less often.
  void observe();

  std::uint64_t contact_steps() const { return contact_steps_; }  // observed with at least one contact
  double deepest_m() const { return deepest_m_; }                 // of all contacts, with the ground too
  // The deepest contact whose surfaces went on closing, and that felt no force.
  double deepest_without_force_m() const { return deepest_without_force_m_; }
  double largest_force_N() const { return largest_force_N_; }
  const std::vector<LinkPair>& pairs() const { return pairs_; }

 private:
  void observe_contacts();
  void observe_pairs();
  double closing_m_per_s(const sim::Contact& contact) const;

  const sim::RobotDescription& robot_;
  const sim::World& world_;
  std::uint64_t contact_steps_ = 0;
  double deepest_m_ = 0.0;
  double deepest_without_force_m_ = 0.0;
  double largest_force_N_ = 0.0;
  std::vector<LinkPair> pairs_;
};

}  // namespace koboshi::tools
