#pragma once

#include <span>
#include <vector>

#include "sim_board/description/description.h"
#include "studio/view/inertia_marks.h"
#include "studio/view/link_marks.h"

namespace koboshi::studio {

// The model editor's marks on the links of a robot: the frame of the chosen one with the axis of the joint
// that moves it, and the inertia of all.
class ModelLayer {
 public:
  int chosen_link = -1;  // -1: none
  bool inertias = false;

  // Without a robot, nothing is shown.
  void set_robot(const sim_board::RobotDescription* robot);
  void add(view::Marks& marks, std::span<const view::Pose> links) const;

 private:
  std::vector<InertiaEllipsoid> ellipsoids_;
  std::vector<JointAxis> axes_;
};

}  // namespace koboshi::studio
