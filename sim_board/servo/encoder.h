#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "sim_board/description/description.h"
#include "sim_board/random/random_stream.h"
#include "sim_board/servo/position_unit.h"

namespace koboshi::sim_board {

// The absolute encoder on a servo's output shaft: mounting error, noise, rounding to the nearest count. It
// keeps account of turns.
class Encoder {
 public:
  // 1 to kPositionBits bits a turn. Noise is `noise_scale` times that of the description, of a stream with
  // this seed and name.
  explicit Encoder(const EncoderDescription& encoder, std::uint64_t seed = 1, double noise_scale = 1.0,
                   std::string_view name = "encoder")
      : counts_per_turn_(1 << encoder.bits),
        units_per_count_(1 << (kPositionBits - encoder.bits)),
        offset_rad_(encoder.offset_rad),
        noise_counts_(noise_scale * encoder.noise_counts),
        random_(seed, name) {}

  std::int32_t read_counts(double shaft_rad) {
    const double turns = (shaft_rad + offset_rad_) / (2.0 * std::numbers::pi);
    const double noise = noise_counts_ == 0.0 ? 0.0 : noise_counts_ * random_.normal();
    return static_cast<std::int32_t>(std::floor(counts_per_turn_ * turns + noise + 0.5));
  }
  std::int32_t position_units(std::int32_t counts) const { return counts * units_per_count_; }

 private:
  double counts_per_turn_;  // a power of two: the product is exact
  std::int32_t units_per_count_;
  double offset_rad_;
  double noise_counts_;
  RandomStream random_;
};

}  // namespace koboshi::sim_board
