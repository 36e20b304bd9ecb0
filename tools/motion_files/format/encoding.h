#pragma once

#include <string>
#include <string_view>

namespace koboshi::tools {

// A text file of another system.
struct DecodedText {
  std::string text;  // UTF-8, LF at its line ends, no byte order mark
  std::string
      encoding;  // from which it was converted; empty: it was UTF-8, or is kept with bytes that are not
};

// Decodes UTF-8, UTF-16 with a byte order mark, Shift-JIS (CP932), EUC-KR and CP949, which files of Japanese
// and Korean robots have in names and comments. Bytes of no encoding stay as they are.
[[nodiscard]] DecodedText decode_text(std::string_view bytes);

}  // namespace koboshi::tools
