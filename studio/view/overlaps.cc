#include "studio/view/overlaps.h"

#include <cstddef>
#include <set>
#include <variant>

namespace koboshi::studio {
namespace {

constexpr double kEdgeRadius_m = 0.0008;
constexpr view::Colour kRed{0.9F, 0.05F, 0.05F};

void add_edges(view::Marks& marks, const Eigen::Isometry3d& X_WG, const Eigen::Vector3d& size_m) {
  const auto corner = [&](int bits) {
    const Eigen::Vector3d side((bits & 1) != 0 ? 0.5 : -0.5, (bits & 2) != 0 ? 0.5 : -0.5,
                               (bits & 4) != 0 ? 0.5 : -0.5);
    return Eigen::Vector3d(X_WG * side.cwiseProduct(size_m));
  };
  for (int from = 0; from < 8; ++from)
    for (const int axis : {1, 2, 4})
      if ((from & axis) == 0) view::add_rod(marks, corner(from), corner(from | axis), kEdgeRadius_m, kRed);
}

}  // namespace

OverlapFinder::OverlapFinder(const sim_board::RobotDescription& robot) : pairs_(robot) {}

std::vector<int> OverlapFinder::links_in_overlap(std::span<const view::Pose> links) const {
  std::vector<Eigen::Isometry3d> X_WLs;
  for (const view::Pose& link : links)
    X_WLs.emplace_back(Eigen::Translation3d(link.p_WL_m.cast<double>()) * link.q_WL.cast<double>());
  std::set<int> found;
  for (const tools::Overlap& overlap : pairs_.all(X_WLs)) found.insert({overlap.link, overlap.other_link});
  return {found.begin(), found.end()};
}

void add_outlines(view::Marks& marks, const view::Scene& scene, std::span<const view::Pose> links,
                  std::span<const int> outlined) {
  for (const int link : outlined) {
    const view::Pose& pose = links[static_cast<std::size_t>(link)];
    Eigen::Isometry3d X_WL = Eigen::Isometry3d::Identity();
    X_WL.linear() = pose.q_WL.cast<double>().toRotationMatrix();
    X_WL.translation() = pose.p_WL_m.cast<double>();
    for (const view::Shape& shape : scene.links[static_cast<std::size_t>(link)].collisions)
      if (const auto* box = std::get_if<view::Box>(&shape.geometry))
        add_edges(marks, X_WL * shape.X_LG, box->size_m);
  }
}

}  // namespace koboshi::studio
