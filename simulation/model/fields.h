#pragma once

#include <vector>

#include "base/text/error.h"
#include "firmware/robot/model.h"
#include "sim_board/description/description.h"

namespace koboshi::simulation {

// Returns the fields of the robot model as stored in its image, except `id` and `order`, which reading sets.
// Appends an error, with file and line, for each property that a RobotModel cannot represent; the result is
// meaningless then.
[[nodiscard]] robot::RobotModel model_fields(const sim_board::RobotDescription& robot,
                                             std::vector<InputError>& errors);

// Calls `set` and appends the error that it throws.
template <typename Set>
void collect_error(std::vector<InputError>& errors, const Set& set) {
  try {
    set();
  } catch (const InputError& error) {
    errors.push_back(error);
  }
}

}  // namespace koboshi::simulation
