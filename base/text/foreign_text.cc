#include "base/text/foreign_text.h"

#include <algorithm>
#include <ios>

namespace koboshi {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

}  // namespace

std::string with_line_feeds(std::string_view text) {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n' && i > 0 && text[i - 1] == '\r') continue;
    result += text[i] == '\r' ? '\n' : text[i];
  }
  return result;
}

std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;  // in any locale
  });
  return extension;
}

bool LineReader::next(std::string& line) {
  line.clear();
  has_end_ = false;
  const std::istream::sentry ready(stream_, true);
  if (!ready) return false;
  try {
    read(line);
  } catch (const std::ios_base::failure&) {
    stream_.setstate(std::ios_base::badbit);
    return false;
  }
  if (line.empty() && !has_end_) return false;
  if (is_first_ && line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
  is_first_ = false;
  return true;
}

void LineReader::read(std::string& line) {
  std::streambuf& bytes = *stream_.rdbuf();
  while (line.size() < kMaxBytes) {
    const int byte = bytes.sbumpc();
    if (byte == std::streambuf::traits_type::eof()) {
      stream_.setstate(std::ios_base::eofbit);
      return;
    }
    const bool continues_return = byte == '\n' && after_return_;
    after_return_ = byte == '\r';
    if (continues_return) continue;
    has_end_ = byte == '\n' || byte == '\r';
    if (has_end_) return;
    line += static_cast<char>(byte);
  }
}

}  // namespace koboshi
