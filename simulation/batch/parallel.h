#pragma once

#include <cstddef>
#include <functional>

namespace koboshi::simulation {

// Number of hardware threads of this machine, at least 1.
[[nodiscard]] std::size_t core_count();

// Calls task(0) to task(count - 1) once each in `jobs` threads, started in this order. Calls `go_on` before
// each and starts no more tasks once it returns false; running tasks complete. Returns the number of started
// tasks. If tasks throw, no more are started, and the exception of the first failed task, in order, is
// rethrown.
std::size_t for_each_parallel(
    std::size_t count, std::size_t jobs, const std::function<void(std::size_t)>& task,
    const std::function<bool()>& go_on = [] { return true; });

}  // namespace koboshi::simulation
