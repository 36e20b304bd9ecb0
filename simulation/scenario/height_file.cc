#include "simulation/scenario/height_file.h"

#include <algorithm>
#include <ranges>
#include <string>
#include <string_view>
#include <vector>

#include "base/text/error.h"
#include "base/text/foreign_text.h"
#include "base/text/text.h"

namespace koboshi::simulation {
namespace {

namespace fs = std::filesystem;

constexpr double kHighest_m = 10.0;

struct Line {
  std::string_view text;
  int number;
};

// Returns the lines that are not blank, without comments after '#'.
std::vector<Line> lines_of(std::string_view text) {
  std::vector<Line> lines;
  int number = 0;
  for (const auto part : std::views::split(text, '\n')) {
    ++number;
    std::string_view line(part.begin(), part.end());
    line = line.substr(0, line.find('#'));
    if (line.find_first_not_of(" \t") != std::string_view::npos) lines.push_back({line, number});
  }
  return lines;
}

void check_size(const fs::path& file, const Line& line, std::size_t count, const std::string& what) {
  if (count < 2 || count > kMaxHeightPoints)
    throw InputError(file, line.number, std::to_string(count) + " " + what,
                     "2 to " + std::to_string(kMaxHeightPoints));
}

// The words of a plain PGM file with their line numbers, in file order.
class Words {
 public:
  Words(const fs::path& file, const std::vector<Line>& lines) : file_(file) {
    for (const Line& line : lines) {
      std::size_t begin = 0;
      while ((begin = line.text.find_first_not_of(" \t", begin)) != std::string_view::npos) {
        const std::size_t end = std::min(line.text.find_first_of(" \t", begin), line.text.size());
        words_.push_back({line.text.substr(begin, end - begin), line.number});
        begin = end;
      }
    }
  }

  std::size_t next(std::int64_t lowest, std::int64_t highest) {
    const IntegerRange range{.min = lowest, .max = highest};
    if (next_ == words_.size()) throw InputError(file_, last_line(), "the end of the image", describe(range));
    const Line& word = words_[next_++];
    const auto value = parse_integer(word.text);
    if (!value || *value < range.min || *value > range.max)
      throw InputError(file_, word.number, one_line(word.text), describe(range));
    return static_cast<std::size_t>(*value);
  }
  void skip() { ++next_; }
  void finish() const {
    if (next_ < words_.size())
      throw InputError(file_, words_[next_].number, one_line(words_[next_].text), "the end of the image");
  }

 private:
  int last_line() const { return words_.empty() ? 0 : words_.back().number; }

  const fs::path& file_;
  std::vector<Line> words_;
  std::size_t next_ = 0;
};

sim_board::HeightField read_image(const fs::path& file, const std::vector<Line>& lines) {
  constexpr std::int64_t kBrightest = 65535;
  Words words(file, lines);
  words.skip();  // P2
  sim_board::HeightField field;
  field.columns = static_cast<int>(words.next(2, kMaxHeightPoints));
  field.rows = static_cast<int>(words.next(2, kMaxHeightPoints));
  const std::size_t brightest = words.next(1, kBrightest);
  const auto count = static_cast<std::size_t>(field.columns) * static_cast<std::size_t>(field.rows);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t grey = words.next(0, static_cast<std::int64_t>(brightest));
    field.heights_m.push_back(static_cast<double>(grey) / static_cast<double>(brightest));
  }
  words.finish();
  return field;
}

sim_board::HeightField read_table(const fs::path& file, const std::vector<Line>& lines) {
  constexpr NumberRange kHeight_m{.min = -kHighest_m, .max = kHighest_m};
  sim_board::HeightField field;
  for (const Line& line : lines) {
    std::size_t count = 0;
    for (const auto part : std::views::split(line.text, ',')) {
      const std::string_view word(part.begin(), part.end());
      const auto height_m = parse_number(word);
      if (!height_m || *height_m < kHeight_m.min || *height_m > kHeight_m.max)
        throw InputError(file, line.number, one_line(word), describe(kHeight_m));
      field.heights_m.push_back(*height_m);
      ++count;
    }
    check_size(file, line, count, "heights in a line");
    if (&line == &lines.front()) field.columns = static_cast<int>(count);
    if (count != static_cast<std::size_t>(field.columns))
      throw InputError(file, line.number, std::to_string(count) + " heights",
                       std::to_string(field.columns) + " as in the first line");
  }
  check_size(file, lines.back(), lines.size(), "lines");
  field.rows = static_cast<int>(lines.size());
  return field;
}

// Reverses the rows: a file begins with the row of highest y, a field with that of lowest y.
void turn_over(sim_board::HeightField& field) {
  for (int row = 0; row < field.rows / 2; ++row) {
    const auto begin = field.heights_m.begin() + row * field.columns;
    std::swap_ranges(begin, begin + field.columns, field.heights_m.end() - (row + 1) * field.columns);
  }
}

}  // namespace

HeightFile read_height_file(const fs::path& file) {
  const std::string bytes = read_text_file(file, "a file of heights");
  if (bytes.starts_with("P5"))
    throw InputError(file, 1, "a binary PGM (P5)", "a plain one (P2), as pnmtoplainpnm makes it");
  const std::string text = with_line_feeds(bytes);
  const std::vector<Line> lines = lines_of(text);
  if (lines.empty()) throw InputError(file, 1, "no heights", "comma-separated heights or a plain PGM (P2)");
  require_utf8(text, file);
  HeightFile heights;
  heights.is_image = text.starts_with("P2");
  heights.field = heights.is_image ? read_image(file, lines) : read_table(file, lines);
  turn_over(heights.field);
  return heights;
}

}  // namespace koboshi::simulation
