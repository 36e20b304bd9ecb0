#include "tools/teleop/key.h"

#include <algorithm>
#include <iterator>

namespace koboshi::tools {
namespace {

constexpr char kEscape = '\x1B';

struct KeyRow {
  Key key;
  std::string_view name;
  std::string_view letters;
  char arrow = '\0';                   // final byte of its sequence
  std::string_view browser_name = {};  // if it is not one of the letters
};
constexpr KeyRow kKeyRows[] = {
    {Key::kForward, "forward", "w", 'A', "ArrowUp"},
    {Key::kBackward, "backward", "s", 'B', "ArrowDown"},
    {Key::kTurnLeft, "turn left", "", 'D', "ArrowLeft"},
    {Key::kTurnRight, "turn right", "", 'C', "ArrowRight"},
    {Key::kLeft, "left", "a,"},
    {Key::kRight, "right", "d."},
    {Key::kGo, "go", "g\n\r", '\0', "Enter"},
    {Key::kStop, "stop", " "},
    {Key::kPush, "push", "p"},
    {Key::kPushMore, "push more", "+"},
    {Key::kPushLess, "push less", "-"},
    {Key::kEnable, "enable", "n"},
    {Key::kGetUp, "get up", "u"},
    {Key::kEmergencyStop, "emergency stop", "e"},
    {Key::kReset, "reset", "r"},
    {Key::kEnd, "end", "qx"},
};

bool is_printable(char byte) { return byte >= ' ' && byte <= '~'; }

std::optional<Key> arrow(char final_byte) {
  const auto* row = std::ranges::find(kKeyRows, final_byte, &KeyRow::arrow);
  return row == std::end(kKeyRows) ? std::nullopt : std::optional(row->key);
}

std::optional<Key> letter(char byte) {
  const auto* row = std::ranges::find_if(
      kKeyRows, [byte](const KeyRow& one) { return one.letters.find(byte) != std::string_view::npos; });
  return row == std::end(kKeyRows) ? std::nullopt : std::optional(row->key);
}

}  // namespace

std::string_view name_of(Key key) { return std::ranges::find(kKeyRows, key, &KeyRow::key)->name; }

std::optional<Key> key_of_browser(std::string_view name) {
  const auto* row = std::ranges::find_if(
      kKeyRows, [name](const KeyRow& one) { return !name.empty() && one.browser_name == name; });
  if (row != std::end(kKeyRows)) return row->key;
  return name.size() == 1 && is_printable(name.front()) ? letter(name.front()) : std::nullopt;
}

std::vector<KeyHelp> key_help() {
  std::vector<KeyHelp> help;
  for (const KeyRow& row : kKeyRows) {
    KeyHelp& one = help.emplace_back(KeyHelp{{}, row.name});
    if (!row.browser_name.empty()) one.browser_keys.emplace_back(row.browser_name);
    for (const char letter : row.letters) {
      if (is_printable(letter)) one.browser_keys.emplace_back(1, letter);
    }
  }
  return help;
}

std::optional<Key> KeyDecoder::take(char byte) {
  if (byte == kEscape) {
    state_ = State::kEscape;
    return std::nullopt;
  }
  switch (state_) {
    case State::kPlain:
      return letter(byte);
    case State::kEscape:
      // Escape itself is not a key, so any other byte after it is one.
      state_ = byte == '[' || byte == 'O' ? State::kSequence : State::kPlain;
      return state_ == State::kPlain ? letter(byte) : std::nullopt;
    case State::kSequence: {
      const bool ends = byte >= '@' && byte <= '~';
      if (!ends) return std::nullopt;
      state_ = State::kPlain;
      return arrow(byte);
    }
  }
  return std::nullopt;
}

}  // namespace koboshi::tools
