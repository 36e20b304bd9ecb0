#include "tools/teleop/key.h"

namespace koboshi::tools {
namespace {

constexpr char kEscape = '\x1B';

std::optional<Key> arrow(char final_byte) {
  switch (final_byte) {
    case 'A':
      return Key::kForward;
    case 'B':
      return Key::kBackward;
    case 'C':
      return Key::kTurnRight;
    case 'D':
      return Key::kTurnLeft;
    default:
      return std::nullopt;
  }
}

std::optional<Key> letter(char byte) {
  switch (byte) {
    case 'w':
      return Key::kForward;
    case 's':
      return Key::kBackward;
    case 'a':
    case ',':
      return Key::kLeft;
    case 'd':
    case '.':
      return Key::kRight;
    case 'g':
    case '\n':
    case '\r':
      return Key::kGo;
    case ' ':
      return Key::kStop;
    case 'p':
      return Key::kPush;
    case '+':
      return Key::kPushMore;
    case '-':
      return Key::kPushLess;
    case 'n':
      return Key::kEnable;
    case 'u':
      return Key::kGetUp;
    case 'e':
      return Key::kEmergencyStop;
    case 'r':
      return Key::kReset;
    case 'q':
    case 'x':
      return Key::kEnd;
    default:
      return std::nullopt;
  }
}

}  // namespace

std::string_view name_of(Key key) {
  switch (key) {
    case Key::kForward:
      return "forward";
    case Key::kBackward:
      return "backward";
    case Key::kTurnLeft:
      return "turn left";
    case Key::kTurnRight:
      return "turn right";
    case Key::kLeft:
      return "left";
    case Key::kRight:
      return "right";
    case Key::kGo:
      return "go";
    case Key::kStop:
      return "stop";
    case Key::kPush:
      return "push";
    case Key::kPushMore:
      return "push more";
    case Key::kPushLess:
      return "push less";
    case Key::kEnable:
      return "enable";
    case Key::kGetUp:
      return "get up";
    case Key::kEmergencyStop:
      return "emergency stop";
    case Key::kReset:
      return "reset";
    case Key::kEnd:
      return "end";
  }
  return {};
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
      // Escape itself is no key here, so what follows it otherwise is one of its own.
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
