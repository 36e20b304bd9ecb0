#include "sim_board/drive/profile_position.h"

#include "firmware/canopen/cia402.h"
#include "sim_board/drive/motion_limits.h"

namespace koboshi::sim {

namespace cia402 = canopen::cia402;

void ProfilePosition::restart(std::int32_t position, std::uint16_t controlword) {
  *this = {};
  target_ = position;
  controlword_ = controlword;
}

void ProfilePosition::step(const DriveValues& values, std::uint64_t now_us, PositionDemand& demand) {
  const bool edge = (values.controlword & ~controlword_ & cia402::kNewSetPoint) != 0;
  controlword_ = values.controlword;
  if (moving_ && started_ && demand.stands(now_us)) moving_.reset();
  if (edge) take_set_point(values, demand.at(now_us));
  obey_halt(values, now_us, demand);
  if (!moving_ && waiting_) {
    moving_.swap(waiting_);
    started_ = false;
  }
  if (moving_ && !started_ && !halted_) {
    demand.move(moving_->target, now_us, moving_->limits);
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

void ProfilePosition::obey_halt(const DriveValues& values, std::uint64_t now_us, PositionDemand& demand) {
  const bool halt = (values.controlword & cia402::kHalt) != 0;
  if (halt && !halted_ && !demand.stands(now_us)) {
    const bool quick = values.halt_option == cia402::kStopOnQuickStopRamp;
    demand.stop(now_us,
                quick ? values.quick_stop_deceleration : profile_limits(values).deceleration_units_per_s2);
  }
  if (halt) started_ = false;  // what is left of the way is gone when the halt is taken back
  halted_ = halt;
}

}  // namespace koboshi::sim
