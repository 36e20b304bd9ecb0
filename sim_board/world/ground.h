#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "sim_board/description/description.h"

namespace koboshi::sim_board {

// The ground for all engines: a plane, patches with different friction, fixed boxes and height fields. Ramps
// and stairs are boxes, see below. Equations and sources: docs/reference/ground.md.

// An area of the plane with its own surface properties and no height.
struct FrictionPatch {
  enum class Outline { kRectangle, kDisc };

  Eigen::Isometry3d X_WP = Eigen::Isometry3d::Identity();  // origin at the centre, z along the plane's normal
  Outline outline = Outline::kRectangle;
  Eigen::Vector2d size_m = Eigen::Vector2d::Ones();  // along x and y; the first is a disc's diameter
  SurfaceDescription surface;

  // Returns whether the point's projection along z is in the patch.
  bool holds(const Eigen::Vector3d& p_W) const;
};

struct GroundBox {
  Eigen::Isometry3d X_WG = Eigen::Isometry3d::Identity();  // origin at the centre
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();
  SurfaceDescription surface;
};

// A height field on a grid. Each cell consists of two triangles that share the diagonal from the corner of
// lowest x and y to that of highest x and y. The solid extends downwards without limit and ends at the rim.
struct HeightField {
  Eigen::Isometry3d X_WF = Eigen::Isometry3d::Identity();  // origin at the centre, heights along z
  Eigen::Vector2d size_m = Eigen::Vector2d::Ones();        // along x and y, from the first to the last point
  int columns = 0;                                         // points along x, at least two
  int rows = 0;                                            // points along y, at least two
  std::vector<double> heights_m;  // columns * rows: in order of increasing y, each row in order of increasing
                                  // x
  SurfaceDescription surface;

  Eigen::Vector2d spacing_m() const;
  Eigen::Vector3d point_F(int column, int row) const;

  struct Place {
    double height_m = 0.0;
    Eigen::Vector3d normal_F = Eigen::Vector3d::UnitZ();  // unit normal of the triangle
  };
  // Returns nothing outside the rim.
  std::optional<Place> at(const Eigen::Vector2d& xy_F) const;
};

struct GroundDescription {
  bool present = true;  // the plane of points p with normal_W . p = offset_m, for a unit normal
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();  // any length but zero
  double offset_m = 0.0;
  SurfaceDescription surface;
  std::vector<FrictionPatch> patches;  // where patches overlap, the last one applies
  std::vector<GroundBox> boxes;
  std::vector<HeightField> height_fields;

  bool is_only_a_plane() const { return boxes.empty() && height_fields.empty(); }
};

// Throws std::invalid_argument for an invalid description.
void check(const GroundDescription& ground);

// A ramp that starts on the plane z = 0 of its frame R, at the y axis, and rises along x to length_m *
// tan(angle). It is a tilted box, thick enough to reach the plane everywhere; its upper end is perpendicular
// to the slope.
struct Ramp {
  Eigen::Isometry3d X_WR = Eigen::Isometry3d::Identity();
  double length_m = 1.0;  // horizontal length, along x
  double width_m = 1.0;   // along y
  double angle_rad = 0.1;
};
GroundBox ramp_box(const Ramp& ramp);

// Stairs that start on the plane z = 0 of their frame R, at the y axis, and rise along x. Each tread is the
// top of a box that stands on the plane.
struct Stairs {
  Eigen::Isometry3d X_WR = Eigen::Isometry3d::Identity();
  int count = 1;
  double rise_m = 0.01;
  double run_m = 0.1;
  double width_m = 1.0;  // along y
};
std::vector<GroundBox> stair_boxes(const Stairs& stairs);

// Returns the height of the point above the highest ground below it, in m; negative inside the ground. For
// the plane it is the distance; for other shapes the distance from the face or triangle below or above the
// point along the shape's z axis. Infinite without ground.
double height_above(const GroundDescription& ground, const Eigen::Vector3d& p_W);

}  // namespace koboshi::sim_board
