#pragma once

#include <cstddef>
#include <functional>

namespace koboshi::simulation {

// How many threads this machine runs at a time, at least 1.
[[nodiscard]] std::size_t core_count();

// Calls task(0) to task(count - 1), each once, in `jobs` threads, started in this order. Asks `go_on` before
// each and starts no more once it says no; what is running is finished. Returns how many were started. When
// tasks throw, no more are started and the exception of the first of them in order is thrown on.
std::size_t for_each_parallel(
    std::size_t count, std::size_t jobs, const std::function<void(std::size_t)>& task,
    const std::function<bool()>& go_on = [] { return true; });

}  // namespace koboshi::simulation
