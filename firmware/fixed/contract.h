#pragma once

#include <cassert>

// What a function demands of its caller, checked wherever the firmware runs. Who breaks it has a defect, and
// nothing after that can be trusted: on the host the program aborts and says where; on the target it traps,
// and the fault handler takes the torque away, leaves a record and starts anew (hal/cortex_m/fault.h). The
// condition must have no side effect.
#if defined(NDEBUG) || defined(__arm__)
#define KOBOSHI_ASSERT(condition) ((condition) ? static_cast<void>(0) : __builtin_trap())
#else
#define KOBOSHI_ASSERT(condition) assert(condition)
#endif
