// motion_*.bin of ROBOTIS: pages of 512 bytes. A page begins with 64 bytes: name (14), repetitions (15),
// schedule (16; 0x0A: steps have times), steps (20), speed (22), acceleration (24), next page (25), exit page
// (26), checksum (31; all bytes of a page sum to 0xFF), slopes by servo (32 to 62). Then seven steps of 64
// bytes: 31 positions of 16 bits, pause, time.

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/text/error.h"
#include "base/text/text.h"
#include "tools/motion_files/format/encoding.h"
#include "tools/motion_files/format/lines.h"
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
constexpr int kScheduleBySpeed = 0;
constexpr int kLargestPosition = 4095;

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

// A page that has steps.
bool has_steps(std::string_view page) { return byte_at(page, 20) > 0; }

// Whether a used page can be one although its checksum is wrong: all that has few right values has one of
// them, and at least one servo moves.
bool is_plausible(std::string_view page) {
  const int steps = byte_at(page, 20);
  const int schedule = byte_at(page, 16);
  if (steps > static_cast<int>(kMostSteps) || !has_name(page)) return false;
  if (schedule != kScheduleByTime && schedule != kScheduleBySpeed) return false;
  bool moves = false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(steps) * kPageServos; ++i) {
    const std::size_t at = kHeaderSize + i / kPageServos * kStepSize + 2 * (i % kPageServos);
    const int position = byte_at(page, at) | byte_at(page, at + 1) << 8;
    constexpr int kFlags = RoboplusStep::kNotUsed | RoboplusStep::kTorqueOff;
    if ((position & ~kFlags) > kLargestPosition) return false;
    moves = moves || (position != 0 && (position & kFlags) == 0);
  }
  return moves;
}

std::vector<std::string_view> pages_in(std::string_view bytes) {
  std::vector<std::string_view> pages;
  for (; bytes.size() >= kPageSize; bytes = bytes.substr(kPageSize))
    pages.push_back(bytes.substr(0, kPageSize));
  return pages;
}

std::string_view raw_name(std::string_view page) {
  const std::string_view name = page.substr(0, kNameSize);
  return name.substr(0, std::min(name.find('\0'), name.size()));
}

// The names of the pages, in the one encoding that has all of them (encoding.h), so that a short name is read
// as the others are. The field may cut the last letter in two.
std::vector<std::string> page_names(const std::vector<std::string_view>& pages,
                                    std::vector<ForeignNote>& notes) {
  std::string whole, cut;
  for (const std::string_view page : pages) {
    const std::string_view name = has_steps(page) ? raw_name(page) : std::string_view();
    const bool half = name.size() == kNameSize && find_invalid_utf8(name) != std::string_view::npos &&
                      decode_text(name).encoding.empty();
    whole.append(name).append("\n");
    cut.append(name.substr(0, name.size() - (half ? 1 : 0))).append("\n");
  }
  DecodedText decoded = decode_text(whole);
  if (find_invalid_utf8(decoded.text) != std::string_view::npos) decoded = decode_text(cut);
  if (!decoded.encoding.empty()) notes.push_back({"names of pages", "are read as " + decoded.encoding});
  std::vector<std::string> names;
  std::string_view text = decoded.text;
  std::string_view line;
  while (names.size() < pages.size() && take_line(text, line)) names.push_back(one_line(trimmed_name(line)));
  names.resize(pages.size());
  return names;
}

RoboplusPage read_page(std::string_view bytes, int number, const std::string& name,
                       std::vector<ForeignNote>& notes) {
  const std::string place = "page " + std::to_string(number);
  RoboplusPage page{.number = number, .name = name};
  const int steps = byte_at(bytes, 20);
  if (steps == 0) return page;
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
  std::vector<std::string_view> used = pages_in(bytes);
  std::erase_if(used, [](std::string_view page) { return !has_steps(page); });
  const auto is_right = [](std::string_view page) {
    return byte_at(page, 20) <= static_cast<int>(kMostSteps) && has_right_sum(page) && has_name(page);
  };
  // Programs of others leave the checksums out.
  return std::ranges::any_of(used, is_right) || (!used.empty() && std::ranges::all_of(used, is_plausible));
}

std::vector<ForeignMotion> read_roboplus_pages(const std::filesystem::path& file, std::string_view bytes) {
  const std::vector<std::string_view> found = pages_in(bytes);
  std::vector<ForeignNote> notes;
  const std::vector<std::string> names = page_names(found, notes);
  std::vector<std::size_t> wrong;
  std::vector<RoboplusPage> pages;
  for (std::size_t i = 0; i < found.size(); ++i) {
    pages.push_back(read_page(found[i], static_cast<int>(i), names[i], notes));
    if (has_steps(found[i]) && !has_right_sum(found[i])) wrong.push_back(i);
  }
  if (wrong.size() > 1 && wrong.size() == static_cast<std::size_t>(std::ranges::count_if(found, has_steps))) {
    notes.push_back({"pages", "all their checksums are wrong; they are read all the same"});
  } else {
    for (const std::size_t page : wrong)
      notes.push_back({"page " + std::to_string(page), "its checksum is wrong; it is read all the same"});
  }
  if (bytes.size() % kPageSize != 0)
    notes.push_back({"end", "the last " + std::to_string(bytes.size() % kPageSize) +
                                " bytes are no whole page, and ignored"});
  std::vector<ForeignMotion> motions = motions_of(MotionFormat::kRoboplusPages, pages, notes);
  if (motions.empty()) throw InputError(file, 0, "pages without a step", "at least one page with steps");
  return motions;
}

}  // namespace koboshi::tools
