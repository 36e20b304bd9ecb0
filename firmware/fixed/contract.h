#pragma once

#include <cassert>

// Checks a precondition of a function, on every platform. A violation is a defect of the program: on the host
// it aborts and names the place; on the target it traps, and the fault handler removes the torque, leaves a
// record and resets (hal/cortex_m/fault.h). The condition must have no side effects.
#if defined(NDEBUG) || defined(__arm__)
#define KOBOSHI_ASSERT(condition) ((condition) ? static_cast<void>(0) : __builtin_trap())
#else
#define KOBOSHI_ASSERT(condition) assert(condition)
#endif
