#pragma once

#include <string>

#include "sim_board/description/edit/model_field.h"

namespace koboshi::studio {

// The texts and the choice of fields that all panels of a robot's values share.

// "gyro noise_density": the usual name of a value, with the elements around it that say something beside it.
[[nodiscard]] std::string label_of(const sim_board::ModelField& field);
// The group of a value in its element: "collision sole". Values of the element itself have its kind: "link".
[[nodiscard]] std::string group_of(const sim_board::ModelField& field);
// Whether the group of a value is an element within the one that is shown.
[[nodiscard]] bool has_inner_group(const sim_board::ModelField& field);
// Whether a panel shows the field: halves instead of whole poses, and missing fields only if the file can
// take them alone.
[[nodiscard]] bool is_shown(const sim_board::ModelField& field);

}  // namespace koboshi::studio
