#include "mechanics/hinge_tree.h"

#include <stdexcept>
#include <utility>

namespace koboshi::mechanics {
namespace {

double position_of(const Coupling& coupling, std::span<const double> positions_rad) {
  return coupling.multiplier * positions_rad[coupling.leader] + coupling.offset_rad;
}

}  // namespace

HingeTree::HingeTree(std::vector<Link> links, std::vector<Hinge> hinges, std::vector<Coupling> couplings)
    : links_(std::move(links)), hinges_(std::move(hinges)), couplings_(std::move(couplings)) {
  if (couplings_.size() > hinges_.size()) throw std::invalid_argument("more couplings than hinges");
  for (const Coupling& coupling : couplings_)
    if (coupling.leader >= free_hinges())
      throw std::invalid_argument("a coupled hinge that follows another one");
  if (links_.empty()) throw std::invalid_argument("no link");
  parents_.assign(links_.size(), 0);
  depths_.assign(links_.size(), 0);
  std::vector<bool> is_reached(links_.size(), false);
  is_reached[0] = true;
  // Each pass reaches at least one more link; the loop ends when a pass reaches none.
  for (bool found = true; found;) {
    found = false;
    for (std::size_t index = 0; index < hinges_.size(); ++index) {
      const Hinge& hinge = hinges_[index];
      if (hinge.parent >= links_.size() || hinge.child >= links_.size())
        throw std::invalid_argument("hinge " + std::to_string(index) + " names no link");
      if (!is_reached[hinge.parent] || is_reached[hinge.child]) continue;
      is_reached[hinge.child] = true;
      parents_[hinge.child] = hinge.parent;
      depths_[hinge.child] = depths_[hinge.parent] + 1;
      hinges_from_root_.push_back(index);
      found = true;
    }
  }
  if (hinges_from_root_.size() != hinges_.size() || hinges_.size() + 1 != links_.size())
    throw std::invalid_argument("the hinges do not make one tree of the links");
  for (const Link& link : links_) mass_kg_ += link.mass_kg;
}

int HingeTree::distance(std::size_t link, std::size_t other_link) const {
  int hinges = 0;
  for (; link != other_link; ++hinges) {
    std::size_t& deeper = depths_[link] >= depths_[other_link] ? link : other_link;
    deeper = parents_[deeper];
  }
  return hinges;
}

bool HingeTree::carries(std::size_t carrier, std::size_t link) const {
  while (depths_[link] > depths_[carrier]) link = parents_[link];
  return link == carrier;
}

std::vector<Eigen::Isometry3d> HingeTree::poses(const Eigen::Isometry3d& X_WB,
                                                std::span<const double> positions_rad) const {
  std::vector<Eigen::Isometry3d> X_WLs;
  poses(X_WB, positions_rad, X_WLs);
  return X_WLs;
}

void HingeTree::poses(const Eigen::Isometry3d& X_WB, std::span<const double> positions_rad,
                      std::vector<Eigen::Isometry3d>& X_WLs) const {
  // Initially X_moved[l] transforms a point of link l from its position at joint positions zero, in the model
  // frame, to its position in the world.
  std::vector<Eigen::Isometry3d>& X_moved = X_WLs;
  X_moved.resize(links_.size());
  X_moved[0] = X_WB * links_[0].X_ML.inverse();
  for (const std::size_t index : hinges_from_root_) {
    const Hinge& hinge = hinges_[index];
    const double position_rad = index < free_hinges()
                                    ? positions_rad[index]
                                    : position_of(couplings_[index - free_hinges()], positions_rad);
    const Eigen::AngleAxisd turn(position_rad, hinge.axis_M);
    const Eigen::Isometry3d X_turn =
        Eigen::Translation3d(hinge.p_MJ) * turn * Eigen::Translation3d(-hinge.p_MJ);
    X_moved[hinge.child] = X_moved[hinge.parent] * X_turn;
  }
  for (std::size_t l = 0; l < X_moved.size(); ++l) X_moved[l] = X_moved[l] * links_[l].X_ML;
}

Eigen::Vector3d HingeTree::centre_of_mass(std::span<const Eigen::Isometry3d> X_WLs) const {
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (std::size_t l = 0; l < links_.size(); ++l)
    moment += links_[l].mass_kg * (X_WLs[l] * links_[l].p_LCom_L);
  return moment / mass_kg_;
}

}  // namespace koboshi::mechanics
