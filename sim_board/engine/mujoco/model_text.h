#pragma once

#include <string>
#include <vector>

#include "sim_board/robot/description.h"
#include "sim_board/world/link_tree.h"
#include "sim_board/world/options.h"
#include "sim_board/world/surface_contact.h"

namespace koboshi::sim {

// A box of a link, numbered by link and in the link's order.
struct NumberedBox {
  int link = -1;
  const BoxDescription* box = nullptr;
};
std::vector<NumberedBox> boxes_of(const RobotDescription& robot);

// A box and another, or the ground, that can touch, and how.
struct TouchingPair {
  static constexpr int kPlane = -1;
  static constexpr int ground_box(int number) { return kPlane - 1 - number; }

  int box = -1;
  int other_box = kPlane;  // kPlane, ground_box(), or a box of a link
  SurfaceContact surface;

  bool with_ground() const { return other_box < 0; }
};

// Boxes whose links at least three joints part, and all boxes with the ground, if there is one: the rule of
// the ODE world. Throws std::invalid_argument for ground and surfaces that this engine has not: patches,
// height fields, friction that depends on the direction, slip in proportion to the force.
std::vector<TouchingPair> touching_pairs(const RobotDescription& robot, const LinkTree& tree,
                                         const WorldOptions& options);

enum class Base { kFree, kFixed };

// A robot that lies, arms and legs crossed, touches with some 60 points. More than this are dropped, with a
// warning.
inline constexpr int kMostContacts = 200;

// A robot and its ground in MuJoCo's XML format. Link i is the body `link<i>`, its frame that of the link;
// joint i is `joint<i>`, and geom_name() tells the boxes' names and those of the ground.
std::string geom_name(int box);
std::string model_text(const RobotDescription& robot, const std::vector<TouchingPair>& pairs,
                       const WorldOptions& options, Base base);

}  // namespace koboshi::sim
