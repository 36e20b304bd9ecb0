#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "view/recording/recording.h"

namespace koboshi::tools {

// A robot as a file of another format describes it, in SI units and radians. The readers (URDF, SDF, MJCF)
// make it, each stage of the import changes it, and the writer writes it as robot.sdf. Frames: L of a link,
// which is the frame of the joint that moves it at joint angle zero; P the parent's; G of a shape; M of the
// model, which is that of the root link.

enum class ShapeKind { kBox, kCylinder, kSphere, kCapsule, kMesh };

struct ImportedShape {
  int line = 0;
  ShapeKind kind = ShapeKind::kBox;
  Eigen::Isometry3d X_LG = Eigen::Isometry3d::Identity();
  // Box: lengths; cylinder and capsule (along z): radius, radius, length of the straight part; sphere:
  // radius.
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
  std::string uri{};  // of a mesh, as the file writes it
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  std::optional<std::array<float, 3>> colour{};  // sRGB
  // The surface in G, in m, with the scale applied. Set by load_surfaces().
  std::shared_ptr<const view::Mesh> surface{};
};

// A place with a name, kept from a link that was merged into another.
struct ImportedFrame {
  std::string name{};
  Eigen::Isometry3d X_LF = Eigen::Isometry3d::Identity();
};

struct ImportedLink {
  std::string name{};
  int line = 0;
  double mass_kg = 0.0;
  bool lacks_mass = false;  // the file gives none for the link, or for a part of it that has a shape
  Eigen::Vector3d p_LCom_L = Eigen::Vector3d::Zero();
  Eigen::Matrix3d I_LCom_L = Eigen::Matrix3d::Zero();  // about the centre of mass, axes of the link
  std::vector<ImportedShape> visuals{};
  std::vector<ImportedShape> collisions{};
  std::vector<ImportedFrame> frames{};
};

enum class JointKind { kHinge, kContinuous, kFixed, kOther };

struct ImportedJoint {
  std::string name{};
  int line = 0;
  JointKind kind = JointKind::kFixed;
  std::string kind_name{};  // as the file writes it, "prismatic"
  int parent = -1;          // index of a link
  int child = -1;
  Eigen::Isometry3d X_PL =
      Eigen::Isometry3d::Identity();                  // child's frame in the parent's at joint angle zero
  Eigen::Vector3d axis_L = Eigen::Vector3d::UnitX();  // unit vector
  std::optional<double> lower_rad{};
  std::optional<double> upper_rad{};
  double effort_Nm = 0.0;            // 0: the file gives none
  double speed_rad_per_s = 0.0;      // 0: the file gives none
  double rotor_inertia_kg_m2 = 0.0;  // reflected to the joint; 0: the file gives none
  double coulomb_friction_Nm = 0.0;  // the same
  // The joint whose angle this one follows: angle = ratio * its angle + offset.
  std::string mimics{};
  double mimic_ratio = 1.0;
  double mimic_offset_rad = 0.0;
  bool is_follower = false;   // the motor of that joint turns this one as well; it has no servo
  bool has_actuator = false;  // a <transmission>, or an actuator of MJCF
  double reduction = 1.0;     // of the <transmission>, > 0
  bool has_stage = false;     // `reduction` is that of gears that the file shows, behind the servo
  std::string servo{};        // its type, as decided
  // The drive measures the joint angle of the source: shaft = sign * angle + zero.
  int drive_sign = 1;
  double drive_zero_rad = 0.0;
};

// Links that something beside the tree connects: a rod of a parallel linkage.
struct ImportedLoop {
  int one = -1;  // index of a link
  int other = -1;
};

struct ImportedRobot {
  std::string name{};
  std::filesystem::path file{};
  std::vector<ImportedLink> links{};
  std::vector<ImportedJoint> joints{};  // in any order
  std::vector<ImportedLoop> loops{};    // of the source's own links, before any are merged

  std::optional<int> find_joint(const std::string& joint_name) const;
};

// Returns the link that is no joint's child. Throws InputError for a file whose joints form no tree: several
// roots, a link with two parents, or a closed loop, which is named with its links.
[[nodiscard]] int root_link(const ImportedRobot& robot);

// Returns the indices of the joints, parents before children. The joints must form a tree.
[[nodiscard]] std::vector<std::size_t> joints_from_root(const ImportedRobot& robot);

// Returns X_ML of every link at the joint angles, which are given by joint; empty: all zero.
[[nodiscard]] std::vector<Eigen::Isometry3d> link_poses(const ImportedRobot& robot,
                                                        std::span<const double> angles_rad = {});

// Returns the index of the joint that moves a link; -1 for the root.
[[nodiscard]] int joint_of(const ImportedRobot& robot, int link);

// Returns the box around the surfaces of shapes, in the link's frame; empty without a surface.
[[nodiscard]] Eigen::AlignedBox3d extent_of(std::span<const ImportedShape> shapes);
// The same of a link: of its collision shapes, or of the visuals of a link without any.
[[nodiscard]] Eigen::AlignedBox3d extent_of(const ImportedLink& link);

// A box around the surfaces of a link, along the axes G of its largest shape. The axes of the link itself are
// its author's choice, on which no size may depend.
struct LinkBox {
  Eigen::Matrix3d R_LG = Eigen::Matrix3d::Identity();
  Eigen::AlignedBox3d extent_G{};  // about the link's origin; empty without a surface

  Eigen::Vector3d center_L() const { return R_LG * extent_G.center(); }
};
// Returns the box around the shapes that extent_of() measures.
[[nodiscard]] LinkBox box_of(const ImportedLink& link);

// Returns the inertia of a uniform box about its centre.
[[nodiscard]] Eigen::Matrix3d box_inertia(double mass_kg, const Eigen::Vector3d& size_m);

}  // namespace koboshi::tools
