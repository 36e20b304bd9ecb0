#pragma once

namespace koboshi::test {

// Returns the number of operator new calls of this thread. Requires koboshi::test_allocations. Direct malloc
// calls, such as those of ODE's arenas, are not counted.
long allocations();

}  // namespace koboshi::test
