#include "base/text/shell_word.h"

namespace koboshi {

std::string shell_word(std::string_view text) {
  constexpr std::string_view kRead = " \t\n'\"$&|;<>()[]{}*?#!\\`~";
  if (!text.empty() && text.find_first_of(kRead) == std::string_view::npos) return std::string(text);
  std::string word = "'";
  for (const char c : text) {
    if (c == '\'')
      word += "'\\''";  // ends the quotes, a quote, and begins them again
    else
      word += c;
  }
  return word + "'";
}

}  // namespace koboshi
