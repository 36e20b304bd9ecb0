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
  char arrow = '\0';  // final byte of its sequence
};
constexpr KeyRow kKeyRows[] = {
    {Key::kForward, "forward", "w", 'A'},
    {Key::kBackward, "backward", "s", 'B'},
    {Key::kTurnLeft, "turn left", "", 'D'},
    {Key::kTurnRight, "turn right", "", 'C'},
    {Key::kLeft, "left", "a,"},
    {Key::kRight, "right", "d."},
    {Key::kGo, "go", "g\n\r"},
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
