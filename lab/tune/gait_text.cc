#include "lab/tune/gait_text.h"

#include <cstddef>
#include <string_view>
#include <vector>

#include "base/text/error.h"
#include "base/text/text.h"

namespace koboshi::lab {
namespace {

struct Place {
  std::size_t begin = 0;
  std::size_t size = 0;
};

// Where a key may begin: at a line's begin, after blanks, or within a map in flow style.
bool begins_a_key(const std::string& text, std::size_t at) {
  return at == 0 || std::string_view(" \n{,").find(text[at - 1]) != std::string_view::npos;
}

bool in_comment(const std::string& text, std::size_t at) {
  const std::size_t line_feed = text.rfind('\n', at);
  const std::size_t hash = text.find('#', line_feed == std::string::npos ? 0 : line_feed);
  return hash < at;
}

// Returns the places of the values of all keys with this name.
std::vector<Place> find_numbers(const std::string& text, const std::string& dotted) {
  const std::string key = dotted.substr(dotted.rfind('.') + 1) + ":";  // all of it without a dot
  std::vector<Place> places;
  for (std::size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + 1)) {
    if (!begins_a_key(text, at) || in_comment(text, at)) continue;
    const std::size_t begin = text.find_first_not_of(' ', at + key.size());
    if (begin == std::string::npos) continue;
    places.push_back({begin, text.find_first_of(" \n,}#", begin) - begin});
  }
  std::erase_if(places, [&](const Place& place) {
    return !koboshi::parse_number(std::string_view(text).substr(place.begin, place.size));
  });
  return places;
}

Place find_number(const std::string& text, const std::string& key, const std::filesystem::path& file) {
  const std::vector<Place> places = find_numbers(text, key);
  if (places.size() == 1) return places.front();
  throw InputError(file, 0, std::to_string(places.size()) + " keys " + key + " with a number", "just one");
}

}  // namespace

bool has_number(const std::string& text, const std::string& key) { return !find_numbers(text, key).empty(); }

double gait_number(const std::string& text, const std::string& key, const std::filesystem::path& file) {
  const Place place = find_number(text, key, file);
  return *koboshi::parse_number(text.substr(place.begin, place.size));
}

std::string with_numbers(std::string text, const GaitNumbers& numbers, const std::filesystem::path& file) {
  for (const auto& [key, value] : numbers) {
    const Place place = find_number(text, key, file);
    text.replace(place.begin, place.size, number_text(value));
  }
  return text;
}

}  // namespace koboshi::lab
