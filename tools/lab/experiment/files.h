#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace koboshi::tools {

// A hash of what is in these files, of these texts, and of the running program, which may compute otherwise
// once it is built anew. 16 digits. Throws sim::InputError where a file cannot be read.
[[nodiscard]] std::string hash_inputs(std::span<const std::filesystem::path> files,
                                      std::span<const std::string> texts);

// Puts a generated section into a page of Markdown whose other parts are written by hand. It stands between
// two comments that name it; a page without it gets it at its end, a page that is missing is begun with
// `title`. Throws sim::InputError where the page has only one of the comments, std::system_error.
void write_section(const std::filesystem::path& page, const std::string& title, const std::string& name,
                   const std::string& text);

}  // namespace koboshi::tools
