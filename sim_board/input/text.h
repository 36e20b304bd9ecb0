#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace koboshi::sim {

// What the YAML and the XML reader share: text of files, numbers and the words of their error messages.

// Both bounds belong to the range.
struct NumberRange {
  double min = -std::numeric_limits<double>::max();
  double max = std::numeric_limits<double>::max();
};
struct IntegerRange {
  std::int64_t min = std::numeric_limits<std::int64_t>::min();
  std::int64_t max = std::numeric_limits<std::int64_t>::max();
};

// The bytes of a file of at most 16 MiB. Throws InputError, with `expected` (e.g. "a YAML file"), where it
// cannot be read.
std::string read_text_file(const std::filesystem::path& file, const std::string& expected);

// A finite decimal number that fills the whole text, blanks around it aside; nothing otherwise. Independent
// of the locale.
std::optional<double> parse_number(std::string_view text);
std::optional<std::int64_t> parse_integer(std::string_view text);
// 0x and hexadecimal digits (YAML 1.2.2, core schema); nothing for others, and from 2^32 on.
std::optional<std::int64_t> parse_hexadecimal(std::string_view text);

// "a number from 0.01 to 3600", "an integer of 1 or more", ...
std::string describe(const NumberRange& range);
std::string describe(const IntegerRange& range);
// "a, b or c"
std::string join_alternatives(std::span<const std::string> names);
// The name that differs least from a misspelt one, by the optimal string alignment distance (insertions,
// deletions, substitutions and transpositions); nothing where more than a third of the letters differ.
std::optional<std::string> nearest_name(std::string_view misspelt, std::span<const std::string> names);
// What a message says was expected instead of a misspelt name: "a, b or c; the nearest is b", or of a long
// list the nearest alone.
std::string expected_names(std::string_view misspelt, std::span<const std::string> names);
// The shortest text that reads back as the same number.
std::string number_text(double value);
// "1 fault", "2 faults"
std::string count_text(std::uint64_t count, const std::string& singular);
// An angle in degrees to 1e-4, as a person would write it.
std::string degrees_text(double angle_rad);
// Text from a file, made fit for one line of a message: control characters replaced, long text cut.
std::string one_line(std::string_view text);

}  // namespace koboshi::sim
