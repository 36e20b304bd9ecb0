#include "sim_board/drive/profile_position.h"

#include "firmware/canopen/cia402.h"
#include "sim_board/drive/motion_limits.h"

namespace koboshi::sim_board {

namespace cia402 = canopen::cia402;

void ProfilePosition::restart(std::int32_t position, std::uint16_t controlword) {
  *this = {};
  target_ = position;
  controlword_ = controlword;
}

void ProfilePosition::step(const DriveValues& values, bool target_given, std::uint64_t now_us,
                           PositionDemand& demand) {
  const bool edge = (values.controlword & ~controlword_ & cia402::kNewSetPoint) != 0;
  controlword_ = values.controlword;
  if (moving_ && started_ && demand.stands(now_us)) moving_.reset();
  if (edge && target_given) take_set_point(values, demand.at(now_us));
  if (edge && !target_given) acknowledges_ = true;
  halted_ = (values.controlword & cia402::kHalt) != 0;
  if (halted_) started_ = false;  // what is left of the way goes on when the halt is taken back
  if (!moving_ && waiting_) {
    moving_.swap(waiting_);
    started_ = false;
  }
  if (moving_ && !started_ && !halted_) {
    demand.move(moving_->target, now_us, moving_->limits, position_range(values));
    started_ = true;
  }
  // The next one may come when the controller has seen this one's acknowledge and there is room.
  if ((controlword_ & cia402::kNewSetPoint) == 0 && !waiting_) acknowledges_ = false;
}

void ProfilePosition::take_set_point(const DriveValues& values, std::int32_t demand) {
  const bool at_once = (values.controlword & cia402::kChangeImmediately) != 0 || !moving_;
  if (!at_once && waiting_) return;  // never acknowledged as free: the controller broke the hand-shake
  std::int64_t target = values.target_position;
  if ((values.controlword & cia402::kRelative) != 0) target += target_;
  target_ = within_limits(values, target, demand);
  clipped_ = target_ != target;
  const ProfileLimits limits = profile_limits(values);
  const SetPoint set_point{target_, limits, limits != asked_limits(values)};
  acknowledges_ = true;
  (at_once ? moving_ : waiting_) = set_point;
  if (!at_once) return;
  waiting_.reset();
  started_ = false;
}

}  // namespace koboshi::sim_board
