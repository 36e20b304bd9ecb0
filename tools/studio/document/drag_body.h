#pragma once

namespace koboshi::studio {

// The bodies of a robot that can be dragged.
enum class DragBody { kTrunk, kLeftFoot, kRightFoot, kLeftHand, kRightHand };

}  // namespace koboshi::studio
