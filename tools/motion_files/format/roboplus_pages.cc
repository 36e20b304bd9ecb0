// motion_*.bin of ROBOTIS: pages of 512 bytes. A page begins with 64 bytes: name (14), repetitions (15),
// schedule (16; 0x0A: steps have times), steps (20), speed (22), acceleration (24), next page (25), exit page
// (26), checksum (31; all bytes of a page sum to 0xFF), slopes by servo (32 to 62). Then seven steps of 64
// bytes: 31 positions of 16 bits, pause, time.

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/text/error.h"
#include "base/text/text.h"
#include "tools/motion_files/format/readers.h"
#include "tools/motion_files/format/roboplus_page.h"

namespace koboshi::tools {
namespace {

constexpr std::size_t kPageSize = 512;
constexpr std::size_t kMostPages = 256;
constexpr std::size_t kHeaderSize = 64;
constexpr std::size_t kStepSize = 64;
constexpr std::size_t kMostSteps = 7;
constexpr std::size_t kPageServos = 31;
constexpr std::size_t kNameSize = 13;
constexpr double kUnit_s =
    0.008;  // of pause and time; nominally 1/128 s, but the players count cycles of 8 ms
constexpr int kScheduleByTime = 0x0A;

int byte_at(std::string_view bytes, std::size_t offset) { return static_cast<unsigned char>(bytes[offset]); }

// A name has ASCII, or letters of a Korean or Japanese encoding, and zeros behind it.
bool has_name(std::string_view page) {
  const std::string_view name = page.substr(0, kNameSize);
  return std::ranges::none_of(name, [](char c) { return c > 0 && c < ' '; });
}

bool has_right_sum(std::string_view page) {
  unsigned sum = 0;
  for (const char byte : page) sum += static_cast<unsigned char>(byte);
  return (sum & 0xFFu) == 0xFFu;
}

std::string page_name(std::string_view page) {
  std::string_view name = page.substr(0, kNameSize);
  name = name.substr(0, std::min(name.find('\0'), name.size()));
  return one_line(trimmed_name(name));
}

RoboplusPage read_page(std::string_view bytes, int number, std::vector<ForeignNote>& notes) {
  const std::string place = "page " + std::to_string(number);
  RoboplusPage page{.number = number, .name = page_name(bytes)};
  const int steps = byte_at(bytes, 20);
  if (steps == 0) return page;
  if (!has_right_sum(bytes)) notes.push_back({place, "its checksum is wrong; it is read all the same"});
  if (steps > static_cast<int>(kMostSteps))
    notes.push_back({place, "says that it has " + std::to_string(steps) + " steps; a page has room for 7"});
  page.repeat = byte_at(bytes, 15);
  page.by_speed = byte_at(bytes, 16) != kScheduleByTime;
  page.speed = byte_at(bytes, 22);
  page.next = byte_at(bytes, 25);
  if (page.speed == 0) notes.push_back({place, "its speed is 0, and read as 32"});
  for (std::size_t i = 0; i < std::min<std::size_t>(static_cast<std::size_t>(steps), kMostSteps); ++i) {
    const std::size_t first = kHeaderSize + i * kStepSize;
    RoboplusStep step;
    for (std::size_t id = 0; id < kPageServos; ++id)
      step.positions.push_back(static_cast<std::uint16_t>(byte_at(bytes, first + 2 * id) |
                                                          byte_at(bytes, first + 2 * id + 1) << 8));
    step.pause_s = kUnit_s * byte_at(bytes, first + 62);
    step.time = byte_at(bytes, first + 63) * (page.by_speed ? 1.0 : kUnit_s);
    page.steps.push_back(std::move(step));
  }
  return page;
}

}  // namespace

bool is_roboplus_pages(std::string_view bytes) {
  if (bytes.size() < kPageSize || bytes.size() > kMostPages * kPageSize) return false;
  // Text has no zeros; a page has many.
  if (bytes.substr(0, kPageSize).find('\0') == std::string_view::npos) return false;
  for (std::size_t first = 0; first + kPageSize <= bytes.size(); first += kPageSize) {
    const std::string_view page = bytes.substr(first, kPageSize);
    const int steps = byte_at(page, 20);
    if (steps > 0 && steps <= static_cast<int>(kMostSteps) && has_right_sum(page) && has_name(page))
      return true;
  }
  return false;
}

std::vector<ForeignMotion> read_roboplus_pages(const std::filesystem::path& file, std::string_view bytes) {
  std::vector<RoboplusPage> pages;
  std::vector<ForeignNote> notes;
  for (std::size_t i = 0; (i + 1) * kPageSize <= bytes.size(); ++i)
    pages.push_back(read_page(bytes.substr(i * kPageSize, kPageSize), static_cast<int>(i), notes));
  if (bytes.size() % kPageSize != 0)
    notes.push_back({"end", "the last " + std::to_string(bytes.size() % kPageSize) +
                                " bytes are no whole page, and ignored"});
  std::vector<ForeignMotion> motions = motions_of(MotionFormat::kRoboplusPages, pages, notes);
  if (motions.empty()) throw InputError(file, 0, "pages without a step", "at least one page with steps");
  return motions;
}

}  // namespace koboshi::tools
