#include "tools/motion_files/format/json_file.h"

#include <algorithm>
#include <cmath>

#include "base/text/error.h"
#include "base/text/text.h"

namespace koboshi::tools {

nlohmann::json parse_json(const std::filesystem::path& file, std::string_view text) {
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    throw InputError(file, static_cast<int>(std::count(text.begin(), end, '\n')) + 1, "text that is no JSON",
                     "a JSON document");
  } catch (const nlohmann::json::exception&) {
    throw InputError(file, 0, "a number that is too large, or text that is not UTF-8", "a JSON document");
  }
}

std::optional<double> number_in(const nlohmann::json& object, const char* key) {
  const auto member = object.find(key);
  if (member == object.end() || !member->is_number()) return std::nullopt;
  const auto number = member->get<double>();
  return std::isfinite(number) ? std::optional(number) : std::nullopt;
}

std::string text_in(const nlohmann::json& object, const char* key) {
  const auto member = object.find(key);
  return member != object.end() && member->is_string() ? one_line(member->get_ref<const std::string&>())
                                                       : std::string();
}

const nlohmann::json& list_in(const std::filesystem::path& file, const nlohmann::json& object,
                              const char* key) {
  const auto member = object.find(key);
  if (member == object.end() || !member->is_array() || member->empty())
    throw InputError(file, 0, std::string("no list '") + key + "'", "a list with at least one item");
  return *member;
}

}  // namespace koboshi::tools
