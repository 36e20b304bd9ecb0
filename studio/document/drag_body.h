#pragma once

namespace koboshi::studio {

// The bodies of a robot that can be dragged.
enum class DragBody { kTrunk, kLeftFoot, kRightFoot, kLeftHand, kRightHand };

// The feet that stay where they are while the trunk is dragged.
enum class DragSupport { kBothFeet, kLeftFoot, kRightFoot };

}  // namespace koboshi::studio
