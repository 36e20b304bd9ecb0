#pragma once

#include <cstdint>
#include <span>

#include "view/recording/recording.h"

namespace koboshi::studio {

// The load of a CAN bus of 1 Mbit/s, 0..1, that follows from recorded frames: the share of `window_us` before
// `time_us` that the frames which ended then, and their intermissions, have taken. It counts as
// sim_board::bus_load does, but sees no error frames. `frames` are in the order of their ends.
[[nodiscard]] double load_of_frames(std::span<const view::Frame> frames, std::uint64_t time_us,
                                    std::uint64_t window_us = 1'000'000);

}  // namespace koboshi::studio
