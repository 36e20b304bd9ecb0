#include "simulation/observe/self_contact.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim_board/board/sim_board.h"
#include "sim_board/description/hinge_tree.h"

namespace koboshi::simulation {

SelfContacts::SelfContacts(const sim_board::RobotDescription& robot) : tree_(sim_board::hinge_tree(robot)) {}

std::optional<SelfContact> SelfContacts::observe(const sim_board::World& world, const Telemetry& said) {
  std::vector<std::pair<int, int>> pairs;
  for (const sim_board::Contact& contact : world.contacts())
    if (contact.other_link >= 0) pairs.push_back(std::minmax(contact.link, contact.other_link));
  std::ranges::sort(pairs);
  const auto repeated = std::ranges::unique(pairs);  // a pair may touch at several points
  pairs.erase(repeated.begin(), repeated.end());

  std::optional<SelfContact> reported;
  for (const auto& [link, other_link] : pairs) {
    auto contact = std::ranges::find_if(contacts_, [&](const SelfContact& known) {
      return known.link == link && known.other_link == other_link;
    });
    if (contact == contacts_.end())
      contact = contacts_.insert(contacts_.end(), {.link = link, .other_link = other_link});
    const bool is_known = contact->duration_us >= kReported_us;
    // Two pairs that reach the limit in one tick are reported one after the other.
    if (!is_known && reported && contact->duration_us + sim_board::SimBoard::kTick_us >= kReported_us)
      continue;
    contact->duration_us += sim_board::SimBoard::kTick_us;
    if (is_known || contact->duration_us < kReported_us) continue;
    find_obstructed_joint(*contact, said);
    reported = *contact;
  }
  return reported;
}

void SelfContacts::find_obstructed_joint(SelfContact& contact, const Telemetry& said) const {
  for (std::size_t joint = 0; joint < tree_.free_hinges(); ++joint) {
    const std::size_t child = tree_.hinges()[joint].child;
    const bool is_between = tree_.carries(child, static_cast<std::size_t>(contact.link)) !=
                            tree_.carries(child, static_cast<std::size_t>(contact.other_link));
    const double error_rad = said.joints[joint].position_rad - said.joints[joint].target_rad;
    if (!is_between || (contact.joint >= 0 && std::abs(error_rad) <= std::abs(contact.following_error_rad)))
      continue;
    contact.joint = static_cast<int>(joint);
    contact.following_error_rad = error_rad;
  }
}

void SelfContacts::archive(sim_board::StateArchive& archive) { archive(contacts_); }

}  // namespace koboshi::simulation
