#include "tools/import/normalise/repair_links.h"

#include <cmath>

#include <fmt/format.h>

#include "base/text/text.h"
#include "base/text/user_units.h"
#include "mechanics/axes.h"

namespace koboshi::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// An inertia with respect to that of a uniform box around the link: the bounds of R002 of `koboshi model
// check`.
constexpr double kMaxShare = 3.3;
constexpr double kMinShare = 1.0 / 40.0;
// A centre of mass this far outside of the box around a link, as a share of its diagonal, is still inside:
// shapes leave screws, cables and small servos out.
constexpr double kOutsideShare = 0.2;
// A link of this size is a placeholder (a millimetre box), not a body.
constexpr double kDummy_m = 0.005;
// A body without a shape: a ball of aluminium of its mass.
constexpr double kDensity_kg_per_m3 = 2700.0;
// A mass of zero stands for a part that nobody weighed.
constexpr double kMinMass_kg = 0.001;
constexpr double kBracketDensity_kg_per_m3 = 300.0;  // of a link's box: servos with air between them

bool is_body(const Matrix3d& inertia) {
  const Vector3d moments = mechanics::principal_inertia(inertia).moments;
  return moments[0] > 1e-12 && moments[2] <= (moments[0] + moments[1]) * (1.0 + 1e-6);
}

// How much larger an inertia is than that of a box; the most extreme share of the three axes. 0: no body at
// all.
double share_of(const Matrix3d& inertia, const Matrix3d& uniform) {
  double extreme = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double share = inertia(axis, axis) / uniform(axis, axis);
    if (!(share > 0.0)) return 0.0;
    if (std::abs(std::log(share)) > std::abs(std::log(extreme))) extreme = share;
  }
  return extreme;
}

Matrix3d ball_inertia(double mass_kg) {
  const double radius_m = std::cbrt(3.0 * mass_kg / (4.0 * 3.14159265 * kDensity_kg_per_m3));
  return 0.4 * mass_kg * radius_m * radius_m * Matrix3d::Identity();
}

void repair_without_shape(ImportedLink& link, Interview& interview, ImportReport& report) {
  const Matrix3d ball = ball_inertia(link.mass_kg);
  // The radius of gyration of a part without a shape: 50 mm, the size of a servo.
  constexpr double kMaxGyration_m = 0.05;
  if (is_body(link.I_LCom_L) && link.I_LCom_L.trace() < 2.0 * link.mass_kg * kMaxGyration_m * kMaxGyration_m)
    return;
  if (take_repair({.key = link.name + ".inertia",
                   .found = fmt::format("link {} (line {}) without a shape, inertia {:.3g} kg m^2",
                                        one_line(link.name), link.line, link.I_LCom_L.trace() / 3.0),
                   .taken = fmt::format("{:.3g} kg m^2, a ball of its mass", ball(0, 0)),
                   .because = "a part without a shape cannot have the inertia of a large body"},
                  interview, report))
    link.I_LCom_L = ball;
}

// `reach_G`: from the link's joint to those that it carries, also where its shapes leave that out, in the
// axes of its box.
void repair_com(ImportedLink& link, const LinkBox& box, const Eigen::AlignedBox3d& reach_G,
                Interview& interview, ImportReport& report) {
  const Vector3d middle = box.center_L();
  const double outside_m = reach_G.exteriorDistance(Vector3d(box.R_LG.transpose() * link.p_LCom_L));
  if (outside_m <= kOutsideShare * reach_G.diagonal().norm()) return;
  if (take_repair({.key = link.name + ".com",
                   .found = fmt::format("link {} (line {}) with its centre of mass at {}",
                                        one_line(link.name), link.line, millimetres(link.p_LCom_L)),
                   .taken = millimetres(middle) + ", the middle of its shape",
                   .because = fmt::format("that is {:.1f} mm outside of its shape", kMmPerM * outside_m)},
                  interview, report))
    link.p_LCom_L = middle;
}

void repair_inertia(ImportedLink& link, const LinkBox& box, const Eigen::AlignedBox3d& reach_G,
                    Interview& interview, ImportReport& report) {
  constexpr double kMinSide_m = 0.002;
  const Matrix3d uniform = box_inertia(link.mass_kg, box.extent_G.sizes().cwiseMax(kMinSide_m));
  const Matrix3d I_LCom_G = box.R_LG.transpose() * link.I_LCom_L * box.R_LG;
  const double within = share_of(I_LCom_G, box_inertia(link.mass_kg, reach_G.sizes().cwiseMax(kMinSide_m)));
  const double share = share_of(I_LCom_G, uniform);
  const bool is_in_proportion =
      (within <= kMaxShare && within >= kMinShare) || (share <= kMaxShare && share >= kMinShare);
  if (is_body(link.I_LCom_L) && is_in_proportion) return;
  const std::string because =
      share > 0.0 && !is_in_proportion
          ? fmt::format("that is {:.3g} times the inertia of a uniform box of its size", share)
          : "no rigid body has such moments";
  if (take_repair({.key = link.name + ".inertia",
                   .found = fmt::format(
                       "link {} (line {}) with moments of inertia {:.3g}, {:.3g}, {:.3g} kg m^2",
                       one_line(link.name), link.line, I_LCom_G(0, 0), I_LCom_G(1, 1), I_LCom_G(2, 2)),
                   .taken = fmt::format("{:.3g}, {:.3g}, {:.3g} kg m^2, a uniform box", uniform(0, 0),
                                        uniform(1, 1), uniform(2, 2)),
                   .because = because},
                  interview, report))
    link.I_LCom_L = box.R_LG * uniform * box.R_LG.transpose();
}

}  // namespace

bool take_repair(ImportRepair repair, Interview& interview, ImportReport& report) {
  const auto given = interview.given().repairs.find(repair.key);
  repair.is_kept = given != interview.given().repairs.end() && given->second == "keep";
  interview.taken.repairs[repair.key] = repair.is_kept ? "keep" : "take";
  report.repairs.push_back(repair);
  return !repair.is_kept;
}

void repair_links(ImportedRobot& robot, Interview& interview, ImportReport& report) {
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    ImportedLink& link = robot.links[i];
    if (link.mass_kg <= 1e-6) {  // a frame, or a part that nobody weighed
      const Eigen::AlignedBox3d extent = extent_of(link);
      link.lacks_mass = !extent.isEmpty() && extent.sizes().maxCoeff() >= kDummy_m;
      link.mass_kg = 0.0;
      link.I_LCom_L.setZero();
      continue;
    }
    const LinkBox box = box_of(link);
    if (box.extent_G.isEmpty() || box.extent_G.sizes().maxCoeff() < kDummy_m) {
      repair_without_shape(link, interview, report);
      continue;
    }
    Eigen::AlignedBox3d reach_G = box.extent_G;
    reach_G.extend(Vector3d::Zero());
    for (const ImportedJoint& joint : robot.joints)
      if (joint.parent == static_cast<int>(i))
        reach_G.extend(Vector3d(box.R_LG.transpose() * joint.X_PL.translation()));
    repair_com(link, box, reach_G, interview, report);
    repair_inertia(link, box, reach_G, interview, report);
  }
}

void repair_masses(ImportedRobot& robot, Interview& interview, ImportReport& report) {
  for (ImportedLink& link : robot.links) {
    if (link.mass_kg >= kMinMass_kg) continue;
    const LinkBox box = box_of(link);
    const Eigen::AlignedBox3d& extent = box.extent_G;
    const bool has_shape = !extent.isEmpty() && extent.sizes().maxCoeff() >= kDummy_m;
    const Vector3d size_m = has_shape ? Vector3d(extent.sizes().cwiseMax(0.002)) : Vector3d::Constant(0.02);
    const double mass_kg = std::max(kBracketDensity_kg_per_m3 * size_m.prod(), 0.005);
    if (!take_repair({.key = link.name + ".mass",
                      .found = fmt::format("link {} (line {}) of {:.3g} g", one_line(link.name), link.line,
                                           1000.0 * link.mass_kg),
                      .taken = fmt::format("{:.3g} g", 1000.0 * mass_kg),
                      .because = "a link between two joints holds at least a bracket"},
                     interview, report) &&
        link.mass_kg > 1e-6)
      continue;
    link.mass_kg = mass_kg;
    link.lacks_mass = true;
    link.p_LCom_L = has_shape ? box.center_L() : Vector3d::Zero();
    link.I_LCom_L = box.R_LG * box_inertia(mass_kg, size_m) * box.R_LG.transpose();
  }
}

}  // namespace koboshi::tools
