#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace koboshi::lab {

// Numbers by the dotted keys of a gait file: "period_s", "feedback.ankle_pitch_s". The last part of a key
// occurs once in the file.
using GaitNumbers = std::map<std::string, double>;

[[nodiscard]] bool has_number(const std::string& text, const std::string& key);

// The number at a key. Throws InputError, naming `file`, unless the text has the key once, with a
// number.
[[nodiscard]] double gait_number(const std::string& text, const std::string& key,
                                 const std::filesystem::path& file);

// Returns the text of a gait file with other numbers; its comments and order stay. Throws the same.
[[nodiscard]] std::string with_numbers(std::string text, const GaitNumbers& numbers,
                                       const std::filesystem::path& file);

}  // namespace koboshi::lab
