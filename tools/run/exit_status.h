#pragma once

#include <functional>
#include <span>
#include <string>

namespace koboshi::tools {

inline constexpr int kFailed = 1;
inline constexpr int kBadInput = 2;
inline constexpr int kSignalled = 128;  // plus the signal's number, as in shells

// Calls `body` and returns the exit status of the program: that of `body`, or kFailed, kBadInput or
// kSignalled for an exception, which one line on standard error reports. `name` begins the lines that name
// no file.
//
// Call it before any file is opened: it reserves the closed ones of the standard streams. Arguments that are
// not UTF-8 are refused, because messages and records repeat them. Text that cannot be written to standard
// output gives kBadInput, like any other file.
[[nodiscard]] int exit_status_of(const std::string& name, std::span<char* const> arguments,
                                 const std::function<int()>& body);

}  // namespace koboshi::tools
