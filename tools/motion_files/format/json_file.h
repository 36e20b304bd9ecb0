#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace koboshi::tools {

// Parses a JSON document. Throws InputError with the line of the first error.
[[nodiscard]] nlohmann::json parse_json(const std::filesystem::path& file, std::string_view text);

// The member of an object, if it is there and a finite number.
[[nodiscard]] std::optional<double> number_in(const nlohmann::json& object, const char* key);

// The member of an object, if it is there and a text; else an empty one. Control characters are replaced.
[[nodiscard]] std::string text_in(const nlohmann::json& object, const char* key);

// The list under a key. Throws InputError if there is none or if it is empty.
[[nodiscard]] const nlohmann::json& list_in(const std::filesystem::path& file, const nlohmann::json& object,
                                            const char* key);

}  // namespace koboshi::tools
