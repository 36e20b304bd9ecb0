#pragma once

#include <ode/ode.h>

#include <cstdint>
#include <memory>

#include "sim_board/engine/delete_by.h"

namespace koboshi::sim {

// ODE's objects with their owners.
using OdeThreading = std::unique_ptr<dxThreadingImplementation, DeleteBy<dThreadingFreeImplementation>>;
using OdeWorldHandle = std::unique_ptr<dxWorld, DeleteBy<dWorldDestroy>>;
using OdeBody = std::unique_ptr<dxBody, DeleteBy<dBodyDestroy>>;
using OdeJoint = std::unique_ptr<dxJoint, DeleteBy<dJointDestroy>>;
using OdeJointGroup = std::unique_ptr<dxJointGroup, DeleteBy<dJointGroupDestroy>>;
using OdeGeom = std::unique_ptr<dxGeom, DeleteBy<dGeomDestroy>>;

// What ODE keeps once for a process, arranged so that several worlds do not disturb each other: start-up,
// per-thread data, the message handler and the random numbers.

// Starts the library and its data of this thread; free after the first call in a thread. Must precede any
// other call.
void start_ode_in_this_thread();

// While it lives, what ODE complains of in this thread is added to `warnings`; outside of any, it is dropped
// (set-up noise).
class OdeWarningCount {
 public:
  explicit OdeWarningCount(std::uint64_t& warnings);
  ~OdeWarningCount();
  OdeWarningCount(const OdeWarningCount&) = delete;
  OdeWarningCount& operator=(const OdeWarningCount&) = delete;
};

// QuickStep shuffles its rows with random numbers whose seed is one for the process. This steps the world
// with the seed given and leaves the seed's successor in it; worlds in other threads wait.
void quick_step(dWorldID world, double step_s, unsigned long& seed);

}  // namespace koboshi::sim
