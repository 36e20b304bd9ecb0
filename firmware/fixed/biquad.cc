#include "firmware/fixed/biquad.h"

namespace koboshi::fixed {

void BiquadFilter::reset(std::int32_t value_raw) {
  input_1_ = input_2_ = value_raw;
  output_1_ = output_2_ = {.whole = value_raw};
}

}  // namespace koboshi::fixed
