#pragma once

#include <cstdint>
#include <memory>

#include "sim_board/board/board_options.h"
#include "sim_board/board/electronics.h"

namespace koboshi::sim_board {

// Called before each physics step, to disturb the robot in it.
class StepListener {
 public:
  virtual void before_step(World& world, std::uint64_t start_us, std::uint64_t end_us) = 0;

 protected:
  ~StepListener() = default;
};

// A robot in its world, and the simulated clock. Sequence of one millisecond: the electronics serve; then
// physics advances to the end of the millisecond together with supply, motors and gears, and the sensors
// sample. A process may contain several boards.
class SimBoard {
 public:
  static constexpr std::uint64_t kService_us = Electronics::kService_us;
  static constexpr std::uint64_t kTick_us = Electronics::kTick_us;

  // Powers everything on at time zero. `robot` and `host` must outlive the board. Throws what make_world and
  // the sensors throw.
  SimBoard(const RobotDescription& robot, const BoardOptions& options, ControllerHost& host);
  SimBoard(const SimBoard&) = delete;
  SimBoard& operator=(const SimBoard&) = delete;

  // Advances one millisecond. Throws WorldBlewUp, and what the host throws.
  void advance() {
    gather();
    complete();
  }
  // The two parts of advance(), for a controller that decides between them: after gather() the input of the
  // firmware is complete, and complete() serves the firmware and advances physics to the end of the
  // millisecond.
  void gather() { electronics_.gather(); }
  void complete();

  std::uint64_t now_us() const { return now_us_; }
  World& world() { return *world_; }
  const World& world() const { return *world_; }
  const GroundDescription& ground() const { return options_.world.ground; }
  const std::vector<FreeBodyDescription>& free_bodies() const { return options_.world.free_bodies; }
  Electronics& electronics() { return electronics_; }
  const Electronics& electronics() const { return electronics_; }
  const TimeShares& time_shares() const { return shares_; }

  // Null removes it. It must outlive the board or be removed before.
  void set_step_listener(StepListener* listener) { step_listener_ = listener; }

  // Saves or restores the whole board including the firmware, between two calls of `advance`. Excludes the
  // measured wall times. Throws as Electronics::archive does.
  void archive(StateArchive& archive);

 private:
  void step_world();

  const BoardOptions options_;
  std::uint64_t now_us_ = 0;
  std::unique_ptr<World> world_;
  std::uint64_t step_us_;
  TimeShares shares_;
  StepListener* step_listener_ = nullptr;
  Electronics electronics_;
};

}  // namespace koboshi::sim_board
