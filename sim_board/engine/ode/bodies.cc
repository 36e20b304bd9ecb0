#include "sim_board/engine/ode/bodies.h"

#include <stdexcept>

#include "sim_board/engine/ode/eigen.h"

namespace koboshi::sim_board {
namespace {

// Inertia of a unit mass at `r` about the origin.
Eigen::Matrix3d of_point(const Eigen::Vector3d& r) {
  return r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose();
}

}  // namespace

void Bodies::Inertia::carry(const Inertia& other) {
  I_LCom_L += other.I_LCom_L + other.mass_kg * of_point(other.p_LCom_L - p_LCom_L);
  mass_kg += other.mass_kg;
}

Bodies::Bodies(dWorldID world, const RobotDescription& robot, std::span<const HingeChain> chains) {
  for (const LinkDescription& link : robot.links) {
    if (!(link.mass_kg > 0.0) || link.I_LCom_L.llt().info() != Eigen::Success)
      throw std::invalid_argument("link '" + link.name + "' has no positive mass and inertia");
    entries_.push_back({.inertia = {link.mass_kg, link.p_LCom_L, link.I_LCom_L}});
  }
  const auto joint = [&](int index) { return robot.joints.at(static_cast<std::size_t>(index)); };
  for (const HingeChain& chain : chains) {
    for (std::size_t i = 0; i + 1 < chain.joints.size(); ++i) {
      const int carrier =
          i < chain.cut ? joint(chain.joints.front()).parent : joint(chain.joints.back()).child;
      let_ride(robot, joint(chain.joints[i]).child, carrier);
    }
  }
  for (std::size_t l = 0; l < entries_.size(); ++l) {
    if (entries_[l].rides_on >= 0) continue;
    const Inertia& inertia = entries_[l].inertia;
    const Eigen::Matrix3d& I = inertia.I_LCom_L;
    entries_[l].body = bodies_.size();
    links_.push_back(static_cast<int>(l));
    bodies_.emplace_back(dBodyCreate(world));
    dMass mass;
    dMassSetParameters(&mass, inertia.mass_kg, 0.0, 0.0, 0.0, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2),
                       I(1, 2));
    dBodySetMass(bodies_.back().get(), &mass);
    set_pose(static_cast<int>(l), robot.links[l].X_ML);
  }
}

void Bodies::let_ride(const RobotDescription& robot, int link, int carrier) {
  const auto& links = robot.links;
  const Eigen::Isometry3d X_CL =
      links[static_cast<std::size_t>(carrier)].X_ML.inverse() * links[static_cast<std::size_t>(link)].X_ML;
  const Inertia& own = at(link).inertia;
  at(carrier).inertia.carry({.mass_kg = own.mass_kg,
                             .p_LCom_L = X_CL * own.p_LCom_L,
                             .I_LCom_L = X_CL.linear() * own.I_LCom_L * X_CL.linear().transpose()});
  at(link).rides_on = carrier;
}

std::size_t Bodies::index_of(int link) const {
  const Entry& entry = at(link);
  return entry.rides_on < 0 ? entry.body : at(entry.rides_on).body;
}

void Bodies::set_pose(int link, const Eigen::Isometry3d& X_WL) {
  sim_board::set_pose(of(link), X_WL * Eigen::Translation3d(p_LCom_L(link)));
}

BodyState Bodies::state(int link) const {
  const dBodyID body = of(link);
  return {pose_of(body) * Eigen::Translation3d(-p_LCom_L(link)), vector_of(dBodyGetLinearVel(body)),
          vector_of(dBodyGetAngularVel(body))};
}

}  // namespace koboshi::sim_board
