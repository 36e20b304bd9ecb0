#include "firmware/estimation/torque_contact.h"

namespace koboshi::estimation {

TorqueContact::TorqueContact(const robot::RobotModel& model)
    : joints_{model.leg_joints(hal::Side::kLeft), model.leg_joints(hal::Side::kRight)} {}

const hal::BySide<bool>& TorqueContact::update(const LegEvidence& evidence) {
  const auto& torques_permille = evidence.torques_permille;
  for (std::size_t side = 0; side < efforts_.size(); ++side) {
    std::int32_t sum = 0;
    for (std::size_t joint = 0; joint < torques_permille.size(); ++joint)
      if ((joints_[side] >> joint & 1u) != 0)
        sum += torques_permille[joint] < 0 ? -torques_permille[joint] : torques_permille[joint];
    efforts_[side] += ((sum << kFractionBits) - efforts_[side]) / kSmoothing;
  }
  if (evidence.walks) {
    contacts_ = {evidence.swing != hal::Side::kLeft, evidence.swing != hal::Side::kRight};
  } else {
    follow_torques();
  }
  return contacts_;
}

void TorqueContact::follow_torques() {
  const std::int32_t both = efforts_[0] + efforts_[1];
  if (both < kMinEffort_permille << kFractionBits) {
    contacts_ = {true, true};
    return;
  }
  for (std::size_t side = 0; side < efforts_.size(); ++side) {
    const std::int32_t limit_permille = contacts_[side] ? kLost_permille : kRegained_permille;
    contacts_[side] = std::int64_t{efforts_[side]} * 1'000 >= std::int64_t{both} * limit_permille;
  }
}

}  // namespace koboshi::estimation
