#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "view/recording/recording.h"

namespace koboshi::view {

// The corners of a sole on a robot whose links have these poses, counter-clockwise from above; empty without
// such a sole.
std::vector<Eigen::Vector3d> sole_corners_W_m(const Scene& scene, const std::vector<Pose>& links,
                                              std::size_t side);
// Whether a link touches the ground.
bool touches_ground(const Sample& sample, int link);

// A sole that stood still on the ground.
struct Footprint {
  std::uint64_t start_us = 0;
  std::uint64_t end_us = 0;
  std::size_t side = 0;
  std::vector<Eigen::Vector3d> corners_W_m;  // counter-clockwise from above
};

// The footprints of a recording that may grow: a sole that touches the ground and moves less than 10 mm for
// 150 ms.
class Footprints {
 public:
  // Takes over the samples from this index on; those before it are as in the last call. A recording may have
  // become shorter, such as after a rewind of the run. The result does not depend on the partition into
  // calls.
  void follow(const Recording& recording, std::size_t first_sample);
  // All of them in order of time.
  std::vector<Footprint> all() const;
  // Those that began by this time and ended less than `age_us` before it, in order of time.
  std::vector<Footprint> at(std::uint64_t time_us, std::uint64_t age_us) const;

 private:
  struct Foot {
    std::vector<Footprint> prints;  // also those that are too short
    bool is_open = false;           // the last one goes on
  };

  void forget_after(Foot& foot, const Recording& recording, std::size_t first_sample);
  void add(Foot& foot, std::size_t side, const Scene& scene, const Sample& sample);

  std::array<Foot, 2> feet_;
};

// All footprints of a recording in order of time.
std::vector<Footprint> footprints(const Recording& recording);

}  // namespace koboshi::view
