#pragma once

#include <span>
#include <string>
#include <vector>

#include "mechanics/hinge_tree.h"
#include "sim_board/description/description.h"
#include "sim_board/world/options.h"
#include "sim_board/world/surface_contact.h"

namespace koboshi::sim_board {

// A box with the index of its link, in the link's order.
struct NumberedBox {
  int link = -1;
  const BoxDescription* box = nullptr;
};
std::vector<NumberedBox> boxes_of(const RobotDescription& robot);

// A box that can touch another box or the ground, and their contact properties.
struct TouchingPair {
  static constexpr int kPlane = -1;
  static constexpr int ground_box(int number) { return kPlane - 1 - number; }

  int box = -1;
  int other_box = kPlane;  // kPlane, ground_box(), or a box of a link
  SurfaceContact surface;

  bool with_ground() const { return other_box < 0; }
};

// Returns the pairs that can touch: boxes of links with at least three joints between them, and all boxes
// with the ground, if there is one, as in the ODE worlds. Throws std::invalid_argument for features that this
// engine lacks: friction patches, height fields, direction-dependent friction, and force-dependent slip.
std::vector<TouchingPair> touching_pairs(const RobotDescription& robot, const mechanics::HingeTree& tree,
                                         const WorldOptions& options);

enum class Base { kFree, kFixed };

// Maximum number of contacts. A robot that lies with crossed arms and legs has about 60. Further contacts are
// dropped with a warning. MuJoCo reserves 12 bytes for each pair of rows, and a contact has three rows: 1.4
// MB for 100 contacts, 4.9 MB for 200.
inline constexpr int kMaxContacts = 100;

// Describes a robot and its ground in MuJoCo's XML format. Link i is the body `link<i>` in the link's frame,
// joint i is `joint<i>`, and geom_name() gives the names of boxes and ground.
std::string geom_name(int box);
// Of `followers`, the last joints, each is an equality with its leader.
std::string model_text(const RobotDescription& robot, std::span<const FollowerDescription> followers,
                       const std::vector<TouchingPair>& pairs, const WorldOptions& options, Base base);

}  // namespace koboshi::sim_board
