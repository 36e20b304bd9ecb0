#pragma once

#include <ode/ode.h>

#include <cstdint>
#include <memory>

#include "sim_board/engine/common/delete_by.h"

namespace koboshi::sim_board {

// Owning pointers for ODE's objects.
using OdeThreading = std::unique_ptr<dxThreadingImplementation, DeleteBy<dThreadingFreeImplementation>>;
using OdeWorldHandle = std::unique_ptr<dxWorld, DeleteBy<dWorldDestroy>>;
using OdeBody = std::unique_ptr<dxBody, DeleteBy<dBodyDestroy>>;
using OdeJoint = std::unique_ptr<dxJoint, DeleteBy<dJointDestroy>>;
using OdeJointGroup = std::unique_ptr<dxJointGroup, DeleteBy<dJointGroupDestroy>>;
using OdeGeom = std::unique_ptr<dxGeom, DeleteBy<dGeomDestroy>>;

// CFM of rows that should be rigid, m/(N s) or rad/(N m s): ODE's default in double precision, which keeps
// redundant rows solvable together. A joint that sticks under 0.03 N m creeps at 3e-12 rad/s, a sole under
// 10 N at 1e-9 m/s.
inline constexpr double kStickingForceMixing = 1e-10;

// ODE's global state, managed for use by several worlds: start-up, per-thread data and message handler.

// Initialises the library and its data of this thread; cheap after the first call in a thread. Must be called
// before any other function.
void start_ode_in_this_thread();

// Adds ODE's warnings in this thread to `warnings` during its lifetime. Warnings outside any such object,
// which occur only during set-up, are dropped.
class OdeWarningCount {
 public:
  explicit OdeWarningCount(std::uint64_t& warnings);
  ~OdeWarningCount();
  OdeWarningCount(const OdeWarningCount&) = delete;
  OdeWarningCount& operator=(const OdeWarningCount&) = delete;
};

}  // namespace koboshi::sim_board
