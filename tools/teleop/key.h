#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace koboshi::tools {

// The keys of the operator.
enum class Key {
  kForward,
  kBackward,
  kTurnLeft,
  kTurnRight,
  kLeft,
  kRight,
  kGo,
  kStop,
  kPush,  // in the direction of the next key
  kPushMore,
  kPushLess,
  kEnable,
  kGetUp,
  kEmergencyStop,
  kReset,
  kEnd,
};

std::string_view name_of(Key key);

// Decodes a key by its name in a browser (KeyboardEvent.key of UI Events): "w", "ArrowUp", "Enter".
[[nodiscard]] std::optional<Key> key_of_browser(std::string_view name);

// The keys for an operator to see.
struct KeyHelp {
  std::vector<std::string> browser_keys;  // all that have this meaning
  std::string_view name;
};
[[nodiscard]] std::vector<KeyHelp> key_help();

// Decodes keys from the bytes of a terminal, where an arrow is a sequence of three (ECMA-48, and the
// application mode of the DEC VT100).
class KeyDecoder {
 public:
  // Returns the key that this byte completes; nothing within a sequence and for a byte without a meaning.
  [[nodiscard]] std::optional<Key> take(char byte);

 private:
  enum class State { kPlain, kEscape, kSequence };

  State state_ = State::kPlain;
};

}  // namespace koboshi::tools
