#include "lab/trial/contact_observer.h"

#include <algorithm>

#include "sim_board/description/hinge_tree.h"
#include "sim_board/engine/common/model_constants.h"
#include "sim_board/world/box_overlap.h"

namespace koboshi::lab {

std::vector<LinkPair> link_pairs(const sim_board::RobotDescription& robot) {
  const mechanics::HingeTree tree = sim_board::hinge_tree(robot);
  std::vector<LinkPair> pairs;
  for (int i = 0; i < static_cast<int>(robot.links.size()); ++i) {
    for (int j = i + 1; j < static_cast<int>(robot.links.size()); ++j) {
      const auto is_bare = [&](int link) {
        return robot.links[static_cast<std::size_t>(link)].collisions.empty();
      };
      if (is_bare(i) || is_bare(j)) continue;
      const int joints = tree.distance(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
      pairs.push_back({{i, j}, joints >= sim_board::kMinJointsBetween});
    }
  }
  return pairs;
}

ContactObserver::ContactObserver(const sim_board::RobotDescription& robot, const sim_board::World& world)
    : robot_(robot), world_(world), pairs_(link_pairs(robot)) {}

void ContactObserver::observe() {
  observe_contacts();
  observe_pairs();
}

void ContactObserver::observe_contacts() {
  if (!world_.contacts().empty()) ++extremes_.contact_steps;
  for (const sim_board::Contact& contact : world_.contacts()) {
    extremes_.deepest_m = std::max(extremes_.deepest_m, contact.depth_m);
    extremes_.largest_force_N = std::max(extremes_.largest_force_N, contact.f_W.norm());
    // A contact that opens faster than its overlap asks for needs no force.
    if (contact.f_W.dot(contact.n_W) > 0.0 || closing_m_per_s(contact) <= 0.0) continue;
    extremes_.deepest_without_force_m = std::max(extremes_.deepest_without_force_m, contact.depth_m);
  }
}

double ContactObserver::closing_m_per_s(const sim_board::Contact& contact) const {
  const auto velocity_W = [&](int link) -> Eigen::Vector3d {
    if (link < 0) return Eigen::Vector3d::Zero();
    const sim_board::BodyState state = world_.body(link);
    const Eigen::Vector3d p_WCom_W = state.X_WL * robot_.links[static_cast<std::size_t>(link)].p_LCom_L;
    return state.v_WCom_W + state.w_WL_W.cross(contact.p_W - p_WCom_W);
  };
  return contact.n_W.dot(velocity_W(contact.other_link) - velocity_W(contact.link));
}

void ContactObserver::observe_pairs() {
  for (LinkPair& pair : pairs_) {
    const auto of = [&](int k) { return static_cast<std::size_t>(pair.links[static_cast<std::size_t>(k)]); };
    const Eigen::Isometry3d X_WA = world_.body(pair.links[0]).X_WL;
    const Eigen::Isometry3d X_WB = world_.body(pair.links[1]).X_WL;
    for (const sim_board::BoxDescription& a : robot_.links[of(0)].collisions) {
      for (const sim_board::BoxDescription& b : robot_.links[of(1)].collisions) {
        pair.overlap_m = std::max(pair.overlap_m, sim_board::box_overlap_m(X_WA * a.X_LG, 0.5 * a.size_m,
                                                                           X_WB * b.X_LG, 0.5 * b.size_m));
      }
    }
  }
}

}  // namespace koboshi::lab
