#pragma once

#include "tools/studio/document/motion_rows.h"

namespace koboshi::studio {

// Sizes of the timeline in pixels.
inline constexpr int kLeft = 44;  // for the scales
inline constexpr int kRight = 16;
inline constexpr int kRuler = 20;
inline constexpr int kArrows = 30;
inline constexpr int kSteps = 26;
inline constexpr int kOtherwise = 18;  // the steps of `else`
inline constexpr int kMarginTop = kRuler + kArrows + kSteps + kOtherwise;
inline constexpr int kMargin = 46;
inline constexpr int kCurvesTop = kMarginTop + kMargin;
inline constexpr double kKeyReach_px = 6.0;

inline constexpr double kShortest_s = 0.5;       // that the timeline shows
inline constexpr double kShownRest_s = 0.6;      // of the check, after the end: the robot comes to rest
inline constexpr double kShortestMove_s = 0.01;  // to which a drag leads
inline constexpr double kMostZoom = 200.0;

// Whether a step belongs to an `else`, at whatever depth.
[[nodiscard]] inline bool is_in_else(const MotionRows& rows, const MotionRow& row) {
  const MotionRow* at = &row;
  while (!at->in_else && at->parent) at = &rows.rows[*at->parent];
  return at->in_else;
}

}  // namespace koboshi::studio
