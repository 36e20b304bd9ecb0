#pragma once

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Replaces the collision shapes of each link of an aligned robot by one box along the axes of the base:
// around its collision shapes, or around the visuals of a robot without any. A foot's box is the sole: it
// spans what touches the ground. Boxes of both sides are mirror images if `symmetric`. The error of each box,
// the largest distance from one of its corners to the shape, is a line of `normalised`. Links without a shape
// stay without a box, except for feet. Throws InputError for a foot without a shape.
void fit_boxes(ImportedRobot& robot, bool symmetric, ImportReport& report);

}  // namespace koboshi::tools
