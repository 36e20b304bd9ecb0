#pragma once

#include <optional>
#include <span>
#include <vector>

#include "studio/view/link_marks.h"
#include "studio/view/overlaps.h"
#include "view/recording/recording.h"
#include "view/render/camera.h"
#include "view/render/marks.h"

namespace koboshi::studio {

// The marks on the links of a robot, each of which can be shown or not: their frames, the axes of its
// joints, and the outlines of links that penetrate each other.
class LinkLayers {
 public:
  bool frames = false;
  bool axes = false;
  bool overlaps = false;

  // `robot` gives axes and overlaps; without it, there are none.
  void set_robot(const sim_board::RobotDescription* robot);
  void add(view::Marks& marks, const view::Scene& scene, std::span<const view::Pose> links) const;
  // The shown frames and axes whose images pass this pixel, the nearest first.
  [[nodiscard]] std::vector<MarkName> at(std::span<const view::Pose> links, const view::Camera& camera,
                                         int width_px, int height_px, const Eigen::Vector2d& pixel) const;
  const JointAxis& axis(std::size_t index) const { return axes_.at(index); }

 private:
  std::vector<JointAxis> axes_;
  std::optional<OverlapFinder> overlaps_;
};

}  // namespace koboshi::studio
