// .mtn of ROBOTIS RoboPlus Motion: lines `key=value`. `enable=` names the servos in use, a page stands
// between `page_begin` and `page_end`: `name=`, `compliance=`, `play_param=next exit repeat speed
// acceleration`, and `step=POSITION ... PAUSE TIME` with times in s.

#include <cmath>

#include "base/text/error.h"
#include "base/text/text.h"
#include "tools/motion_files/format/lines.h"
#include "tools/motion_files/format/readers.h"
#include "tools/motion_files/format/roboplus_page.h"

namespace koboshi::tools {
namespace {

constexpr std::size_t kMostServos = 64;
constexpr double kLongestStep_s = 600.0;
constexpr std::size_t kMostTextPages = 256;
constexpr std::size_t kMostTextSteps = 513;  // of a page; one more than a motion can have

class Reader {
 public:
  void read(std::string_view key, std::string_view value, const std::string& place) {
    place_ = place;
    if (key == "enable") {
      for (const std::string_view flag : split(value, ' ')) enabled_.push_back(flag == "1");
    } else if (key == "name" && in_page_) {
      pages_.back().name = one_line(trimmed_name(value));
    } else if (key == "play_param" && in_page_) {
      read_parameters(split(value, ' '));
    } else if (key == "step" && in_page_ && pages_.back().steps.size() < kMostTextSteps) {
      read_step(split(value, ' '));
    } else if (key == "step" && !in_page_) {
      note("ignored: it stands outside of a page");
    }
  }
  void begin_page(const std::string& place) {
    in_page_ = pages_.size() < kMostTextPages;
    if (!in_page_) {
      notes_.push_back({place, "ignored: a file has at most " + std::to_string(kMostTextPages) + " pages"});
      return;
    }
    pages_.push_back({.number = static_cast<int>(pages_.size()) + 1});
  }
  void end_page() { in_page_ = false; }

  const std::vector<RoboplusPage>& pages() const { return pages_; }
  const std::vector<ForeignNote>& notes() const { return notes_; }

 private:
  // Notes about a page name it, so that they go with the motions that play it.
  void note(const std::string& text) {
    notes_.push_back(
        {in_page_ ? "page " + std::to_string(pages_.back().number) + ", " + place_ : place_, text});
  }

  void read_parameters(const std::vector<std::string_view>& fields) {
    RoboplusPage& page = pages_.back();
    if (fields.size() < 4)
      return note("has " + count_text(fields.size(), "parameter") + ", expected next, exit, repeat, speed");
    const auto next = parse_integer(fields[0]);
    const auto repeat = parse_integer(fields[2]);
    const auto speed = parse_number(fields[3]);
    if (next && *next >= 0 && *next <= 256) page.next = static_cast<int>(*next);
    if (repeat && *repeat >= 1 && *repeat <= 65'535) page.repeat = static_cast<int>(*repeat);
    if (speed && *speed > 0.0 && *speed <= 10.0) {
      page.speed = static_cast<int>(std::lround(32.0 * *speed));
    } else {
      note("its speed is none, and read as 1");
    }
  }

  void read_step(const std::vector<std::string_view>& fields) {
    if (fields.size() < 3 || fields.size() > kMostServos + 2)
      return note("ignored: " + count_text(fields.size(), "number") +
                  ", expected positions, a pause and a time");
    const std::size_t servos = fields.size() - 2;
    RoboplusStep step;
    const auto pause_s = parse_number(fields[servos]);
    const auto time_s = parse_number(fields[servos + 1]);
    if (!pause_s || !time_s || *pause_s < 0.0 || *time_s < 0.0 || *pause_s > kLongestStep_s ||
        *time_s > kLongestStep_s)
      return note("ignored: its last two numbers are no pause and time in s");
    step.pause_s = *pause_s;
    step.time = *time_s;
    for (std::size_t id = 0; id < servos; ++id) {
      const auto position = parse_integer(fields[id]);
      const bool used = id >= enabled_.size() || enabled_[id];
      if (!position || *position < 0 || *position > 0x7FFF)
        note("servo " + std::to_string(id) + " keeps its position: '" + one_line(fields[id]) + "' is none");
      step.positions.push_back(used && position && *position >= 0 && *position <= 0x7FFF
                                   ? static_cast<std::uint16_t>(*position)
                                   : RoboplusStep::kNotUsed);
    }
    pages_.back().steps.push_back(std::move(step));
  }

  std::string place_;
  bool in_page_ = false;
  std::vector<bool> enabled_;
  std::vector<RoboplusPage> pages_;
  std::vector<ForeignNote> notes_;
};

}  // namespace

std::vector<ForeignMotion> read_roboplus_text(const std::filesystem::path& file, std::string_view text) {
  Reader reader;
  std::string_view line;
  for (std::size_t number = 1; take_line(text, line); ++number) {
    line = trimmed(line);
    if (line == "page_begin") reader.begin_page(line_place(number));
    if (line == "page_end") reader.end_page();
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) continue;
    reader.read(trimmed(line.substr(0, equals)), trimmed(line.substr(equals + 1)), line_place(number));
  }
  std::vector<ForeignMotion> motions =
      motions_of(MotionFormat::kRoboplusText, reader.pages(), reader.notes());
  if (motions.empty())
    throw InputError(file, 0, "no page with a step", "pages with steps between page_begin and page_end");
  return motions;
}

}  // namespace koboshi::tools
