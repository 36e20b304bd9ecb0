#pragma once

#include "studio/document/motion_rows.h"

namespace koboshi::studio {

// Sizes of the timeline in pixels.
inline constexpr int kLeft = 44;  // for the scales
inline constexpr int kRight = 16;
inline constexpr int kRuler = 20;
inline constexpr int kArrows = 30;
inline constexpr int kSteps = 26;
inline constexpr int kOtherwise = 17;  // of the steps of each `else`
inline constexpr int kMostOtherwise = 4;
inline constexpr int kMargin = 46;
inline constexpr int kLeastCurves = 60;
inline constexpr double kKeyReach_px = 6.0;
inline constexpr double kDragBegin_px = 3.0;

inline constexpr double kShortest_s = 0.5;       // that the timeline shows
inline constexpr double kShownRest_s = 0.6;      // of the check, after the end: the robot comes to rest
inline constexpr double kShortestMove_s = 0.01;  // to which a drag leads
inline constexpr double kMostZoom = 200.0;

// The number of `else` around a step, at most kMostOtherwise: its lane.
[[nodiscard]] inline int else_depth(const MotionRows& rows, const MotionRow& row) {
  int depth = 0;
  for (const MotionRow* at = &row; at != nullptr && depth < kMostOtherwise;
       at = at->parent ? &rows.rows[*at->parent] : nullptr)
    depth += at->in_else ? 1 : 0;
  return depth;
}

}  // namespace koboshi::studio
