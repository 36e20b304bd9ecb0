#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <stdexcept>
#include <string>

#include "sim_board/engine/delete_by.h"

namespace koboshi::sim {

// MuJoCo's objects with their owners.
using MujocoModel = std::unique_ptr<mjModel, DeleteBy<mj_deleteModel>>;
using MujocoData = std::unique_ptr<mjData, DeleteBy<mj_deleteData>>;

// What MuJoCo holds for an error of its caller, or an arena that is full.
class MujocoError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// What MuJoCo keeps once for a process, arranged so that several worlds do not disturb each other. By itself
// it ends the process at an error, and writes a warning to standard output and into a file in the working
// directory; from this call on an error throws MujocoError out of the function that found it, and warnings
// are only counted, in the data of the world that they are of. Must precede any other call.
void start_mujoco();

// The model that a text in MuJoCo's XML format describes. Throws MujocoError with what MuJoCo says of it.
MujocoModel load_model(const std::string& mjcf);

// The memory in which a model moves. Throws MujocoError.
MujocoData make_data(const mjModel& model);

}  // namespace koboshi::sim
