#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "firmware/balance/feedback.h"
#include "firmware/fixed/units.h"
#include "firmware/motion/inputs.h"
#include "firmware/motion/instructions.h"
#include "firmware/walk/walker.h"

namespace koboshi::behaviour {

// The plan of a source for the trunk and the ZMP, and the feedback that balances it.
struct Plan {
  motion::Lean lean;                      // of the trunk: only what deviates from it may be a fall
  fixed::Angle pitch;                     // of the trunk, forward positive: the feedback holds it
  std::optional<walk::PlannedZmp> zmp{};  // for the end of the cycle
  // Set by the plan of a walk: the foot in the air, the foot that bears the robot, and the foot relative to
  // which the motion of the centre of mass is measured.
  std::optional<hal::Side> swing{};
  std::optional<hal::Side> support{};
  std::optional<hal::Side> reference{};
  std::optional<walk::Point> dcm_error{};
  std::optional<std::uint16_t> error_percent{};  // of what the next steps catch (Walker::error_percent)
  balance::FeedbackMode feedback = balance::FeedbackMode::kStanding;
};

// Generates the joint targets of the states whose row in state.h names it. A new source is a class of this
// kind, an enumerator of Source, and a member of Behaviour that is registered there.
class MotionSource {
 public:
  // Advances by `elapsed_us` and writes the targets, one for each joint.
  virtual void advance(std::uint32_t elapsed_us, const motion::Inputs& inputs,
                       std::span<fixed::Angle> targets) = 0;
  // Ends it in an orderly way, which may take many cycles; without effect when it has ended.
  virtual void stop() = 0;
  // Ends it at once: it writes no more targets.
  virtual void abort() = 0;
  [[nodiscard]] virtual bool running() const = 0;
  [[nodiscard]] virtual Plan plan() const { return {}; }

 protected:
  ~MotionSource() = default;
};

}  // namespace koboshi::behaviour
