#pragma once

namespace koboshi::test {

// How often this thread has taken memory by operator new, in a program that links koboshi::test_allocations.
// What comes from malloc alone, such as ODE's arenas, is not counted.
long allocations();

}  // namespace koboshi::test
