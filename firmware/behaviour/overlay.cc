#include "firmware/behaviour/overlay.h"

#include <algorithm>

#include "firmware/fixed/interpolation.h"

namespace koboshi::behaviour {

using fixed::Angle;

void Overlay::start(const motion::Motion& motion, std::span<const Angle> targets,
                    const motion::Inputs& inputs) {
  interpreter_.start(motion, targets, inputs);
  joints_ = motion.claimed_joints();
  returned_us_ = 0;
  std::ranges::copy(targets, first_layer_.begin());
  std::ranges::copy(targets, last_.begin());
}

void Overlay::abort() {
  interpreter_.abort();
  joints_ = 0;
}

void Overlay::uncover(std::span<Angle> targets) const {
  for (std::size_t joint = 0; joint < targets.size(); ++joint) {
    if ((joints_ >> joint & 1u) != 0) targets[joint] = first_layer_[joint];
  }
}

void Overlay::cover(std::uint32_t elapsed_us, const motion::Inputs& inputs, std::span<Angle> targets) {
  if (joints_ == 0) return;
  std::ranges::copy(targets, first_layer_.begin());
  const bool plays = playing();
  if (plays) {
    interpreter_.advance(elapsed_us, inputs);
    std::ranges::copy(interpreter_.targets(), last_.begin());
    interpreter_.add_corrections({last_.data(), targets.size()}, inputs.robot);
  } else {
    returned_us_ += static_cast<std::int32_t>(elapsed_us);
  }
  const fixed::Ratio fraction = plays ? fixed::Ratio() : fixed::elapsed_fraction(returned_us_, kReturn_us);
  for (std::size_t joint = 0; joint < targets.size(); ++joint) {
    if ((joints_ >> joint & 1u) != 0)
      targets[joint] = fixed::interpolate(last_[joint], first_layer_[joint], fraction);
  }
  if (returned_us_ >= kReturn_us) joints_ = 0;
}

}  // namespace koboshi::behaviour
