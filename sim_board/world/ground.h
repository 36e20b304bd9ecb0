#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "sim_board/robot/description.h"

namespace koboshi::sim {

// The ground as every engine gets it: a plane, patches of other friction on it, and fixed boxes and height
// fields. Ramps and stairs are boxes, see below. Equations and sources: docs/reference/ground.md.

// A part of the plane with a surface of its own. It has no height.
struct FrictionPatch {
  enum class Outline { kRectangle, kDisc };

  Eigen::Isometry3d X_WP = Eigen::Isometry3d::Identity();  // origin in the middle, z along the plane's normal
  Outline outline = Outline::kRectangle;
  Eigen::Vector2d size_m = Eigen::Vector2d::Ones();  // along x and y; a disc's diameter is the first
  SurfaceDescription surface;

  // Whether a point, moved along z, lies in the patch.
  bool holds(const Eigen::Vector3d& p_W) const;
};

struct GroundBox {
  Eigen::Isometry3d X_WG = Eigen::Isometry3d::Identity();  // origin in the middle
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();
  SurfaceDescription surface;
};

// Heights over a grid of points. Each cell of four is two triangles; they share the diagonal from the cell's
// corner of lowest x and y to that of the highest. The ground goes down without end below them, and ends at
// the rim.
struct HeightField {
  Eigen::Isometry3d X_WF = Eigen::Isometry3d::Identity();  // origin in the middle, heights along z
  Eigen::Vector2d size_m = Eigen::Vector2d::Ones();        // along x and y, from the first point to the last
  int columns = 0;                                         // points along x, two or more
  int rows = 0;                                            // points along y, two or more
  std::vector<double> heights_m;  // columns * rows: from the lowest y, each row from the lowest x
  SurfaceDescription surface;

  Eigen::Vector2d spacing_m() const;
  Eigen::Vector3d point_F(int column, int row) const;

  struct Place {
    double height_m = 0.0;
    Eigen::Vector3d normal_F = Eigen::Vector3d::UnitZ();  // of the triangle, unit length
  };
  // Nothing beyond the rim.
  std::optional<Place> at(const Eigen::Vector2d& xy_F) const;
};

struct GroundDescription {
  bool present = true;  // the plane: the points p with normal_W . p = offset_m, for a unit normal
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();  // any length but zero
  double offset_m = 0.0;
  SurfaceDescription surface;
  std::vector<FrictionPatch> patches;  // where several hold a point, the last of them counts
  std::vector<GroundBox> boxes;
  std::vector<HeightField> height_fields;

  bool is_only_a_plane() const { return boxes.empty() && height_fields.empty(); }
};

// Throws std::invalid_argument for a description that makes no ground.
void check(const GroundDescription& ground);

// A slope that begins on the plane z = 0 of its frame R, at the frame's y axis, and rises along x to length_m
// * tan(angle). It is a tilted box, thick enough to reach the plane everywhere; beyond its upper end it falls
// off at a right angle to the slope.
struct Ramp {
  Eigen::Isometry3d X_WR = Eigen::Isometry3d::Identity();
  double length_m = 1.0;  // level, along x
  double width_m = 1.0;   // along y
  double angle_rad = 0.1;
};
GroundBox ramp_box(const Ramp& ramp);

// Stairs that begin on the plane z = 0 of their frame R, at the frame's y axis, and climb along x. Each tread
// is the top of one box that stands on the plane.
struct Stairs {
  Eigen::Isometry3d X_WR = Eigen::Isometry3d::Identity();
  int count = 1;
  double rise_m = 0.01;
  double run_m = 0.1;
  double width_m = 1.0;  // along y
};
std::vector<GroundBox> stair_boxes(const Stairs& stairs);

// How far the point lies above the highest ground under it, in m; negative inside the ground. Of the plane it
// is the distance, of all else the distance from the face or triangle that lies below or above it along the
// shape's z axis. Infinite without ground.
double height_above(const GroundDescription& ground, const Eigen::Vector3d& p_W);

}  // namespace koboshi::sim
