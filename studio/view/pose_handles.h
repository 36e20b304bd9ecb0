#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "studio/view/gizmo.h"
#include "studio/view/robot_picture.h"

namespace koboshi::studio {

// The links of a robot that can be posed by dragging, and the arrows and rings at the one of them that was
// under the mouse last.
class PoseHandles {
 public:
  // A link that can be posed, the point of it where its arrows begin, and whether it can be rotated.
  struct Posable {
    int link = 0;
    Eigen::Vector3d p_L_m = Eigen::Vector3d::Zero();
    bool rotates = false;
    bool operator==(const Posable&) const = default;
  };
  // The thing that a press grabs. Nothing of both: none.
  struct Grabbed {
    std::optional<Handle> handle = {};
    std::optional<Hit> link = {};
  };

  // Returns whether they are others than before.
  bool set_links(std::vector<Posable> links);
  // Removes arrows and rings.
  void hide() { link_ = -1; }
  void choose(int link) { link_ = link; }
  int link() const { return link_; }
  // Moves the mouse to this. Returns whether the handles look different then.
  bool hover(const Grabbed& grabbed);

  // The arrows and rings; nothing without such a link.
  std::optional<Gizmo> gizmo(const RobotPicture& picture) const;
  // The handle under the mouse.
  const std::optional<Handle>& hovered() const { return hovered_; }
  // The posable link, and the arrow or ring, under a place.
  std::optional<Hit> link_at(const RobotPicture& picture, const PicturePlace& place) const;
  std::optional<Handle> handle_at(const RobotPicture& picture, const PicturePlace& place) const;
  // Returns the thing that a press at a place grabs: the handle under it, else the posable link under it,
  // else the nearest of both within kNear_px.
  Grabbed grabbed_at(const RobotPicture& picture, const PicturePlace& place, bool with_handles) const;

 private:
  bool is_posable(int link) const;

  std::vector<Posable> links_;
  int link_ = -1;
  std::optional<Handle> hovered_;
};

}  // namespace koboshi::studio
