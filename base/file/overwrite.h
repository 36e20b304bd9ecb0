#pragma once

#include <filesystem>
#include <initializer_list>

namespace koboshi {

// Throws InputError if an output is one of the files that are read, under whatever name: writing it would
// destroy the input. Empty paths and files that do not exist are permitted.
void refuse_to_overwrite(std::initializer_list<std::filesystem::path> inputs,
                         const std::filesystem::path& output);

}  // namespace koboshi
