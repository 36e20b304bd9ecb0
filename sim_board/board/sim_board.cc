#include "sim_board/board/sim_board.h"

#include <cmath>

#include "sim_board/engine/make_world.h"

namespace koboshi::sim_board {

SimBoard::SimBoard(const RobotDescription& robot, const BoardOptions& options, ControllerHost& host)
    : options_(options),
      world_(make_world(robot, options.world)),
      step_us_(static_cast<std::uint64_t>(std::llround(1e6 * world_->step_s()))),
      electronics_(robot, options, *world_, host, shares_) {}

void SimBoard::complete() {
  electronics_.respond();
  for (const std::uint64_t end_us = now_us_ + kService_us; now_us_ < end_us;) {
    if (step_listener_ != nullptr) step_listener_->before_step(*world_, now_us_, now_us_ + step_us_);
    electronics_.drive_servos();
    step_world();
    now_us_ += step_us_;
    electronics_.sample(now_us_);
  }
}

void SimBoard::step_world() {
  const Stopwatch watch(shares_.physics_s, now_us_);
  world_->step();
}

void SimBoard::archive(StateArchive& archive) { archive(now_us_, world_, electronics_); }

}  // namespace koboshi::sim_board
