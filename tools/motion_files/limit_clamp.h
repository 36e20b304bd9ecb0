#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "simulation/model/robot_model.h"

namespace koboshi::tools {

// The share of a servo's speed without load that generated motions use; a loaded one is slower.
inline constexpr double kUsableSpeed = 0.9;

// Brings angles of other robots within a robot's limits, and reports those that it changed.
class LimitClamp {
 public:
  // `largest_rad`: the largest correction; empty: any. `file` is named in messages.
  LimitClamp(const std::filesystem::path& file, const simulation::NamedModel& robot,
             std::optional<double> largest_rad)
      : file_(file), robot_(robot), largest_rad_(largest_rad) {}

  // Returns the angle of this joint within its limits, in rad. A correction beyond the rounding of a
  // converted limit is counted, and `report` gets a line that begins with `place`. Throws InputError for one
  // beyond both the largest and a step of the joint's encoder, by which a robot that was turned by hand to
  // its stop is off.
  [[nodiscard]] double operator()(std::size_t joint, double angle_rad, const std::string& place,
                                  std::vector<std::string>& report);
  std::size_t count() const { return count_; }

 private:
  const std::filesystem::path& file_;
  const simulation::NamedModel& robot_;
  std::optional<double> largest_rad_;
  std::size_t count_ = 0;
};

}  // namespace koboshi::tools
