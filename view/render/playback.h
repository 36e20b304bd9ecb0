#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "view/recording/recording.h"

namespace koboshi::view {

// A recording at any time, not only at its samples.

// Index of the last sample at or before a time; the first one for earlier times.
std::size_t sample_at(const Recording& recording, std::uint64_t time_us);

// Poses between samples: positions linearly, attitudes along the shortest arc. Outside the recording, the
// nearest sample's.
std::vector<Pose> poses_at(const Recording& recording, std::uint64_t time_us);

// Index of the signal of this name, or nothing.
std::optional<std::size_t> find_signal(const Recording& recording, std::string_view name);
// The text of a signal of named values, such as a state; empty without a value or a name for it.
std::string name_of_value(const Recording& recording, std::size_t signal, std::size_t sample);

// The centre of mass of all links in the world.
Eigen::Vector3d centre_of_mass_W_m(const Scene& scene, const std::vector<Pose>& links);

}  // namespace koboshi::view
