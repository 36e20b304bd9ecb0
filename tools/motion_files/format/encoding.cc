#include "tools/motion_files/format/encoding.h"

#include <iconv.h>

#include <array>
#include <optional>

#include "base/text/foreign_text.h"
#include "base/text/text.h"

namespace koboshi::tools {
namespace {

// Returns nothing for bytes that this encoding does not have, and if the system does not know it.
std::optional<std::string> converted(std::string_view bytes, const char* encoding) {
  iconv_t converter = iconv_open("UTF-8", encoding);
  if (converter == reinterpret_cast<iconv_t>(-1)) return std::nullopt;
  std::string input(bytes);
  std::string result;
  std::array<char, 4096> buffer{};
  char* in = input.data();
  std::size_t left = input.size();
  bool is_valid = true;
  while (left > 0 && is_valid) {
    char* out = buffer.data();
    std::size_t space = buffer.size();
    const bool failed = iconv(converter, &in, &left, &out, &space) == static_cast<std::size_t>(-1);
    // A full buffer is no fault of the text: it then has been written to.
    is_valid = !failed || space < buffer.size();
    result.append(buffer.data(), buffer.size() - space);
  }
  iconv_close(converter);
  if (!is_valid) return std::nullopt;
  return result;
}

bool has_utf16_mark(std::string_view bytes) {
  return bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF");
}

}  // namespace

DecodedText decode_text(std::string_view bytes) {
  if (has_utf16_mark(bytes)) {
    if (const auto text = converted(bytes, "UTF-16")) return {with_line_feeds(*text), "UTF-16"};
  }
  if (find_invalid_utf8(bytes) == std::string_view::npos) return {with_line_feeds(bytes), ""};
  // EUC-KR first: its letters are valid Shift-JIS too, as katakana, whereas kana of Shift-JIS are no EUC-KR.
  // CP949, its extension, would take nearly every Japanese text.
  for (const char* encoding : {"EUC-KR", "CP932", "CP949"}) {
    if (const auto text = converted(bytes, encoding)) return {with_line_feeds(*text), encoding};
  }
  return {with_line_feeds(bytes), ""};
}

}  // namespace koboshi::tools
