#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "view/recording/recording.h"
#include "view/render/overlay.h"

namespace koboshi::studio {

// A point of the ground and where it was during the last second.
struct SolePoint {
  enum class Kind { kZmp, kCom, kCapturePoint };
  Kind kind = Kind::kZmp;
  const view::ZmpMark* mark = nullptr;              // of a ZMP
  Eigen::Vector2d now_m = Eigen::Vector2d::Zero();  // NaN: unknown at this moment
  std::vector<Eigen::Vector2d> trail_m = {};        // oldest first, up to now; NaN where unknown
};

// Soles and points of balance at a moment, seen from above. Coordinates are in axes of the ground midway
// between the soles: x forward (the mean heading of the soles), y to the left.
struct SolePicture {
  std::array<std::vector<Eigen::Vector2d>, 2> soles_m = {};  // left, right; counter-clockwise
  std::array<bool, 2> carry = {};                            // the sole touches the ground
  std::vector<Eigen::Vector2d> support_m = {};               // convex, counter-clockwise
  std::vector<SolePoint> points = {};
  // Distance of the true ZMP, or else of the measured or planned one, from the support polygon's edge:
  // positive inside. Without a polygon or a ZMP, nothing.
  std::optional<double> margin_m = {};
  const view::ZmpMark* judged = nullptr;  // the one whose margin it is
};

inline constexpr std::uint64_t kSoleTrail_us = 1'000'000;

// Nothing for a recording without samples or soles. The capture point is c + v sqrt(h / g) with the centre of
// mass c at the height h above the soles (Pratt, Carff, Drakunov and Goswami 2006), the divergent component
// of motion; v is the difference between the samples beside the moment.
[[nodiscard]] std::optional<SolePicture> sole_picture(const view::Recording& recording,
                                                      std::uint64_t time_us);

}  // namespace koboshi::studio
