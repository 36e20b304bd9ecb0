#pragma once

#include <vector>

#include "firmware/robot/model.h"
#include "sim_board/input/error.h"
#include "sim_board/robot/description.h"

namespace koboshi::simulation {

// Returns the fields of the robot model as stored in its image, except `id` and `order`, which reading sets.
// Appends an error, with file and line, for each property that a RobotModel cannot represent; the result is
// meaningless then.
[[nodiscard]] robot::RobotModel model_fields(const sim::RobotDescription& robot,
                                             std::vector<sim::InputError>& errors);

// Calls `set` and appends the error that it throws.
template <typename Set>
void collect_error(std::vector<sim::InputError>& errors, const Set& set) {
  try {
    set();
  } catch (const sim::InputError& error) {
    errors.push_back(error);
  }
}

}  // namespace koboshi::simulation
