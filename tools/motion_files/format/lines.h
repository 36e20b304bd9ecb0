#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace koboshi::tools {

// Takes the next line off `text`, which has LF at its line ends. False at the end.
[[nodiscard]] bool take_line(std::string_view& text, std::string_view& line);

// Without blanks at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

// Splits at each separator; a separator of ' ' is any number of blanks.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, char separator);

// Returns the text with small letters of ASCII.
[[nodiscard]] std::string lower_case(std::string_view text);
[[nodiscard]] std::string line_place(std::size_t line);

}  // namespace koboshi::tools
