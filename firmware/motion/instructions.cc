#include "firmware/motion/instructions.h"

namespace koboshi::motion {

bool ExpectedAttitude::is_met_by(const robot::Direction& up_B_now) const {
  const std::int64_t projection_raw = std::int64_t{up_B_now.x.raw()} * up_B[0] +
                                      std::int64_t{up_B_now.y.raw()} * up_B[1] +
                                      std::int64_t{up_B_now.z.raw()} * up_B[2];
  constexpr int kShift = fixed::Ratio::kFractionBits - 15;
  return projection_raw >= (std::int64_t{min_cosine} * 127 << kShift);
}

}  // namespace koboshi::motion
