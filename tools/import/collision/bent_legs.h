#pragma once

#include "tools/import/collision/boxes.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Cuts boxes of different limbs until they are some millimetres apart while the arms hang and both legs
// squat: the poses in which a scenario hangs the robot up, and in which it stands and walks. Each joint alone
// may be free in its whole range, and a knee and a hip that bend bring the shank beside the hand. Pairs that
// stay too close are a warning. Robots without legs that bend stay as they are.
void clear_bent_legs(Boxes& boxes, BoxCutter& cutter, ImportReport& report);

}  // namespace koboshi::tools
