#pragma once

#include <optional>
#include <string_view>

namespace koboshi::tools {

// What an operator at a keyboard wants.
enum class Key {
  kForward,
  kBackward,
  kTurnLeft,
  kTurnRight,
  kLeft,
  kRight,
  kGo,
  kStop,
  kPush,  // towards the direction of the key that follows
  kPushMore,
  kPushLess,
  kEnable,
  kGetUp,
  kEmergencyStop,
  kReset,
  kEnd,
};

std::string_view name_of(Key key);

// Makes keys of the bytes of a terminal, in which an arrow is a sequence of three (ECMA-48, and the
// application mode of the DEC VT100).
class KeyDecoder {
 public:
  // The key that this byte completes; none in the midst of a sequence, and for whatever means nothing here.
  [[nodiscard]] std::optional<Key> take(char byte);

 private:
  enum class State { kPlain, kEscape, kSequence };

  State state_ = State::kPlain;
};

}  // namespace koboshi::tools
