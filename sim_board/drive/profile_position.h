#pragma once

#include <cstdint>
#include <optional>

#include "sim_board/drive/drive_dictionary.h"
#include "sim_board/drive/motion_profile.h"
#include "sim_board/drive/position_demand.h"

namespace koboshi::sim_board {

// Profile position mode, CiA 402-2: the hand-shake of set-points between controlword and statusword, and the
// moves that come of them. One set-point is on its way and one more may wait for it to arrive; its profile is
// that of the moment in which it was given.
class ProfilePosition {
 public:
  // Forgets all set-points: the drive holds `position`. A bit 4 that is already set gives none.
  void restart(std::int32_t position, std::uint16_t controlword);
  // One loop in operation enabled. Without a `target_given` since the restart, a set-point is acknowledged
  // and moves nothing. Where `halted` becomes true, the caller stops the demand.
  void step(const DriveValues& values, bool target_given, std::uint64_t now_us, PositionDemand& demand);

  bool acknowledges() const { return acknowledges_; }  // statusword bit 12
  bool halted() const { return halted_; }
  // Whether the last target or the dynamics of the move under way exceed the drive's limits.
  bool limited() const { return clipped_ || (moving_ && moving_->limited); }
  bool arrived() const { return !moving_ && !waiting_; }  // the demand, not the shaft
  std::int32_t target() const { return target_; }

 private:
  struct SetPoint {
    std::int32_t target;
    ProfileLimits limits;
    bool limited;
  };

  void take_set_point(const DriveValues& values, std::int32_t demand);

  std::uint16_t controlword_ = 0;
  bool acknowledges_ = false;
  bool halted_ = false;
  bool clipped_ = false;             // target_, to the software position limits
  bool started_ = false;             // the demand follows moving_
  std::optional<SetPoint> moving_;   // on its way, or halted there
  std::optional<SetPoint> waiting_;  // for the other to arrive
  std::int32_t target_ = 0;          // of the last set-point: what a relative one adds to
};

}  // namespace koboshi::sim_board
