#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace koboshi::lab {

// A hash of these files, of these texts, and of the running program, because another build may compute other
// results. 16 digits. Throws InputError where a file cannot be read.
[[nodiscard]] std::string hash_inputs(std::span<const std::filesystem::path> files,
                                      std::span<const std::string> texts);

// Replaces a generated section of a Markdown page whose other parts are written by hand. The section stands
// between two comments that name it. A page without it gets it at its end; a missing page begins with
// `title`. Throws InputError where the page has only one of the comments, std::system_error.
void write_section(const std::filesystem::path& page, const std::string& title, const std::string& name,
                   const std::string& text);

}  // namespace koboshi::lab
