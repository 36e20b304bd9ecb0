#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace koboshi::mechanics {

// A rigid link with its frame L.
struct Link {
  double mass_kg = 0.0;
  Eigen::Vector3d p_LCom_L = Eigen::Vector3d::Zero();      // m
  Eigen::Matrix3d I_LCom_L = Eigen::Matrix3d::Zero();      // about the centre of mass, kg m^2
  Eigen::Isometry3d X_ML = Eigen::Isometry3d::Identity();  // in the model frame M at joint positions zero
};

// A hinge between two links, given by their indices. Anchor and axis are in M at joint positions zero.
struct Hinge {
  std::size_t parent = 0;
  std::size_t child = 0;
  Eigen::Vector3d p_MJ = Eigen::Vector3d::Zero();     // m
  Eigen::Vector3d axis_M = Eigen::Vector3d::UnitZ();  // unit vector
};

// A hinge whose position follows that of another one: multiplier * position of the leader + offset.
struct Coupling {
  std::size_t leader = 0;  // index of a hinge without a coupling
  double multiplier = 1.0;
  double offset_rad = 0.0;
};

// Rigid links that hinges connect to a tree. Link 0 is the root.
class HingeTree {
 public:
  // The hinges may be in any order, but for the last ones: as many as there are couplings follow those before
  // them. Throws std::invalid_argument unless they form one tree of all links, with leaders among the others.
  HingeTree(std::vector<Link> links, std::vector<Hinge> hinges, std::vector<Coupling> couplings = {});

  std::span<const Link> links() const { return links_; }
  std::span<const Hinge> hinges() const { return hinges_; }
  // Number of hinges that have positions of their own; they are the first ones.
  std::size_t free_hinges() const { return hinges_.size() - couplings_.size(); }
  // The couplings of the hinges from free_hinges() on.
  std::span<const Coupling> couplings() const { return couplings_; }
  // Derivative of a hinge's position with respect to that of the free hinge that moves it, and that hinge.
  std::pair<std::size_t, double> free_hinge(std::size_t hinge) const {
    if (hinge < free_hinges()) return {hinge, 1.0};
    const Coupling& coupling = couplings_[hinge - free_hinges()];
    return {coupling.leader, coupling.multiplier};
  }
  double mass_kg() const { return mass_kg_; }
  // Indices of the hinges, parents before children.
  std::span<const std::size_t> hinges_from_root() const { return hinges_from_root_; }
  // Returns the number of hinges between the two links.
  int distance(std::size_t link, std::size_t other_link) const;
  // Whether a link is another one or hangs on it.
  bool carries(std::size_t carrier, std::size_t link) const;

  // Returns X_WL of every link, given that of the root and the positions of the free hinges in rad.
  std::vector<Eigen::Isometry3d> poses(const Eigen::Isometry3d& X_WB,
                                       std::span<const double> positions_rad) const;
  // The same into `X_WLs`, whose memory is reused.
  void poses(const Eigen::Isometry3d& X_WB, std::span<const double> positions_rad,
             std::vector<Eigen::Isometry3d>& X_WLs) const;
  // Returns the centre of mass of links with these poses.
  Eigen::Vector3d centre_of_mass(std::span<const Eigen::Isometry3d> X_WLs) const;

 private:
  std::vector<Link> links_;
  std::vector<Hinge> hinges_;
  std::vector<Coupling> couplings_;
  double mass_kg_ = 0.0;
  std::vector<std::size_t> hinges_from_root_;
  std::vector<std::size_t> parents_;  // by link; that of the root is itself
  std::vector<std::size_t> depths_;   // by link
};

}  // namespace koboshi::mechanics
