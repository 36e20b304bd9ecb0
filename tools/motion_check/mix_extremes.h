#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <unordered_map>
#include <vector>

#include "sim_board/description/description.h"
#include "tools/motion_check/body.h"
#include "tools/motion_check/collision.h"
#include "tools/motion_check/trajectory.h"

namespace koboshi::tools {

// The worst of a pose when the corrections of its mixes are at their bounds. Bit s of a sign mask: the
// deviation that MixBound::source s measures is positive.
struct MixExtreme {
  std::size_t tick = 0;      // one later where the mixes begin: in that tick a step ends before them
  std::uint8_t sources = 0;  // bit s: of the mixes
  Overlap overlap{};         // the deepest self-collision
  std::uint8_t overlap_signs = 0;
  Margin com{};  // the least margin of the centre of mass at rest; if the motion counts on the soles here
  std::uint8_t com_signs = 0;
};

// Evaluates the poses of a path with the corrections of their mixes at the bounds. Joints that one source
// corrects move together, each to its own bound with the sign of its gain; sources are independent of each
// other. A pose with n sources has 2^n extremes, at most 32. Poses are at rest: corrections in motion, and
// joints that have reached their bounds while others of the same source have not, are left out.
class MixExtremes {
 public:
  // Between the ends of steps, a pose is evaluated after each move of a joint by so much.
  static constexpr double kSpacing_rad = 0.0175;
  // The most extremes of a path. The poses of a path with more are thinned out evenly.
  static constexpr std::size_t kMaxExtremes = 16'384;

  // All must outlive the extremes. `stiffness_Nm`: of the servos, by joint, per rad.
  MixExtremes(const sim_board::RobotDescription& robot, Body& body, const CollisionPairs& pairs,
              const std::vector<double>& stiffness_Nm)
      : robot_(robot), body_(body), pairs_(pairs), stiffness_Nm_(stiffness_Nm) {}

  // Returns the extremes of the path's poses with mixes, by tick. `keys`: a hash of the pose for each tick.
  // Returns early, with unusable extremes, once `cancel` is set.
  std::vector<MixExtreme> evaluate(const Trajectory& trajectory, std::span<const std::uint64_t> keys,
                                   const std::stop_token& cancel);
  // Forgets what no path has used since the last call of this function.
  void forget_unused();

 private:
  struct Known {
    MixExtreme extreme;
    std::uint64_t used = 0;
  };

  MixExtreme worst_of(const Trajectory& trajectory, std::size_t tick);
  void apply(std::span<const double> targets_rad, const MixBounds& bounds, std::uint8_t signs);

  const sim_board::RobotDescription& robot_;
  Body& body_;
  const CollisionPairs& pairs_;
  const std::vector<double>& stiffness_Nm_;
  std::unordered_map<std::uint64_t, Known> known_;
  std::uint64_t time_ = 0;  // number of calls of forget_unused

  // Scratch.
  std::vector<double> angles_;
  std::vector<Eigen::Isometry3d> X_BLs_;
  Stance stance_;
};

}  // namespace koboshi::tools
