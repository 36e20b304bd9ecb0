#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "sim_board/robot/description.h"

namespace koboshi::sim {

// Positions on the bus and in a drive's loops are finer than any encoder here: 2^-20 turn.
inline constexpr int kPositionBits = 20;
inline constexpr double kRadPerPositionUnit = 2.0 * std::numbers::pi / (1 << kPositionBits);

// The absolute encoder on a servo's output shaft. It rounds to the nearest count and keeps account of turns.
class Encoder {
 public:
  // 1 to kPositionBits bits a turn.
  explicit Encoder(const EncoderDescription& encoder)
      : bits_(encoder.bits), offset_rad_(encoder.offset_rad) {}

  std::int32_t read_counts(double shaft_rad) const {
    const double turns = (shaft_rad + offset_rad_) / (2.0 * std::numbers::pi);
    return static_cast<std::int32_t>(std::floor(std::ldexp(turns, bits_) + 0.5));
  }
  std::int32_t position_units(std::int32_t counts) const { return counts * (1 << (kPositionBits - bits_)); }

 private:
  int bits_;
  double offset_rad_;
};

}  // namespace koboshi::sim
