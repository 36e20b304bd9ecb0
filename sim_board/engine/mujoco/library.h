#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <stdexcept>
#include <string>

#include "sim_board/engine/common/delete_by.h"

namespace koboshi::sim_board {

// Owning pointers for MuJoCo's objects.
using MujocoModel = std::unique_ptr<mjModel, DeleteBy<mj_deleteModel>>;
using MujocoData = std::unique_ptr<mjData, DeleteBy<mj_deleteData>>;

// An error that MuJoCo reports, such as a caller's error or a full arena.
class MujocoError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Sets MuJoCo's global error handlers for use by several worlds. By default MuJoCo ends the process at an
// error and writes warnings to standard output and to a file in the working directory. After this call,
// errors throw MujocoError, and warnings are only counted in the data of their world. Must be called before
// any other function.
void start_mujoco();

// Compiles a model from text in MuJoCo's XML format. Throws MujocoError with MuJoCo's message.
MujocoModel load_model(const std::string& mjcf);

// Allocates the data of a model. Throws MujocoError.
MujocoData make_data(const mjModel& model);

}  // namespace koboshi::sim_board
