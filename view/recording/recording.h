#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "hal/port/can.h"

namespace koboshi::view {

// A recorded run in memory: what replay page, film and export are made of. SI units and radians; W is the
// world, L a link's frame (docs/design/frames.md). Everything that is drawn is contained, so a recording can
// be shown without robot file, meshes and scenario.

struct Colour {
  float red = 0.0F;  // each 0..1, sRGB
  float green = 0.0F;
  float blue = 0.0F;
};

struct Box {
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();  // centred on its frame
};

// Triangles with counter-clockwise corners as seen from outside.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices_m{};
  std::vector<std::array<std::uint32_t, 3>> triangles{};  // indices of vertices
};

struct Shape {
  std::string name{};
  Eigen::Isometry3d X_LG = Eigen::Isometry3d::Identity();  // pose in the link, or in the world for the ground
  std::variant<Box, Mesh> geometry{};
  Colour colour{};
};

struct Link {
  std::string name{};
  int parent = -1;  // index of the link towards the trunk; -1: the trunk
  double mass_kg = 0.0;
  Eigen::Vector3d p_LCom_L = Eigen::Vector3d::Zero();
  std::vector<Shape> visuals{};
  std::vector<Shape> collisions{};
};

// The plane of points p with normal_W . p = offset_m.
struct Plane {
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();  // unit vector
  double offset_m = 0.0;
};

struct Scene {
  std::string robot{};
  std::vector<Link> links{};
  std::vector<Plane> planes{};  // at most one
  std::vector<Shape> ground{};  // boxes, height fields and friction patches
  // Corners of each sole in its link's frame, counter-clockwise from above, by Side; and the sole's link.
  std::array<std::vector<Eigen::Vector3d>, 2> soles_L{};
  std::array<int, 2> sole_links{-1, -1};
  // Sentences about meshes that cannot be shown. Not recorded.
  std::vector<std::string> mesh_faults{};
};

// A column of Sample::values: those of trace.csv (docs/reference/recording.md).
struct Signal {
  std::string name{};
  std::string unit{};  // empty: without one
  // Names of the values of an integer signal, such as the states; empty for a number.
  std::vector<std::pair<std::int64_t, std::string>> names{};
};

struct Pose {
  Eigen::Vector3f p_WL_m = Eigen::Vector3f::Zero();
  Eigen::Quaternionf q_WL = Eigen::Quaternionf::Identity();
};

struct ContactForce {
  int link = -1;
  int other_link = -1;  // -1: the ground
  Eigen::Vector3f p_W_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f f_W_N = Eigen::Vector3f::Zero();  // on `link`
};

// The state after a tick.
struct Sample {
  std::uint64_t time_us = 0;
  std::vector<Pose> links{};  // by index of Scene::links
  std::vector<ContactForce> contacts{};
  std::vector<float> values{};  // by index of Recording::signals; NaN: no value
};

struct Event {
  std::uint64_t time_us = 0;
  std::string kind{};  // docs/reference/events.md
  std::string text{};
};

// A force on a link during an interval.
struct Push {
  std::uint64_t start_us = 0;
  std::uint64_t end_us = 0;
  int link = 0;
  Eigen::Vector3d p_L_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d f_W_N = Eigen::Vector3d::Zero();
};

struct Frame {
  std::uint64_t end_us = 0;  // end of the last bit of EOF
  hal::CanFrame frame{};
};

// A node on the CAN bus: the controller, a drive by its joint's name, or a sensor.
struct CanNode {
  int id = 0;
  std::string name{};
};

struct Recording {
  std::string title{};     // the scenario's name
  std::string scenario{};  // the text of the file
  std::uint64_t seed = 0;
  std::string stepper{};
  std::string version{};         // of Koboshi
  bool complete = true;          // false: interrupted, read up to its last whole block
  std::vector<CanNode> nodes{};  // empty in recordings that do not name them
  Scene scene{};
  std::vector<Signal> signals{};
  std::vector<Sample> samples{};  // in order of time
  std::vector<Event> events{};
  std::vector<Push> pushes{};
  std::vector<Frame> frames{};
};

}  // namespace koboshi::view
