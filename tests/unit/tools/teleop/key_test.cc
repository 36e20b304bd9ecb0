#include "tools/teleop/key.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tools/teleop/key_queue.h"
#include "tools/teleop/page_keys.h"

namespace koboshi::tools {
namespace {

std::vector<Key> keys_of(std::string_view bytes) {
  KeyDecoder decoder;
  std::vector<Key> keys;
  for (const char byte : bytes) {
    if (const auto key = decoder.take(byte)) keys.push_back(*key);
  }
  return keys;
}

using Keys = std::vector<Key>;

TEST(KeyDecoder, DecodesEveryLetter) {
  EXPECT_EQ(keys_of("wsad,."),
            (Keys{Key::kForward, Key::kBackward, Key::kLeft, Key::kRight, Key::kLeft, Key::kRight}));
  EXPECT_EQ(keys_of("g\n\r "), (Keys{Key::kGo, Key::kGo, Key::kGo, Key::kStop}));
  EXPECT_EQ(keys_of("p+-"), (Keys{Key::kPush, Key::kPushMore, Key::kPushLess}));
  EXPECT_EQ(keys_of("nerqx"), (Keys{Key::kEnable, Key::kEmergencyStop, Key::kReset, Key::kEnd, Key::kEnd}));
}

TEST(KeyDecoder, DecodesTheArrowsInBothModes) {
  const Keys arrows{Key::kForward, Key::kBackward, Key::kTurnRight, Key::kTurnLeft};
  EXPECT_EQ(keys_of("\x1B[A\x1B[B\x1B[C\x1B[D"), arrows);
  EXPECT_EQ(keys_of("\x1BOA\x1BOB\x1BOC\x1BOD"), arrows);
}

// Home, delete, F5, and an arrow with control, which is an arrow all the same: none of their bytes is a
// letter.
TEST(KeyDecoder, SkipsOtherSequencesEntirely) {
  EXPECT_EQ(keys_of("\x1B[H\x1B[3~\x1B[15~g"), (Keys{Key::kGo}));
  EXPECT_EQ(keys_of("\x1B[1;5Ag"), (Keys{Key::kForward, Key::kGo}));
}

TEST(KeyDecoder, IgnoresALoneEscape) {
  EXPECT_EQ(keys_of("\x1B g"), (Keys{Key::kStop, Key::kGo}));
  EXPECT_EQ(keys_of("\x1B\x1B[A"), (Keys{Key::kForward}));
}

TEST(KeyDecoder, IgnoresUnknownBytes) { EXPECT_EQ(keys_of("zZ1\t\x7F\xC3\xA4"), Keys{}); }

TEST(Key, HasAUniqueName) {
  std::set<std::string_view> names;
  for (int key = 0; key <= static_cast<int>(Key::kEnd); ++key) {
    const std::string_view name = name_of(static_cast<Key>(key));
    EXPECT_FALSE(name.empty()) << key;
    EXPECT_TRUE(names.insert(name).second) << name;
  }
}

TEST(KeyOfBrowser, KnowsTheSameKeys) {
  EXPECT_EQ(key_of_browser("w"), Key::kForward);
  EXPECT_EQ(key_of_browser(" "), Key::kStop);
  EXPECT_EQ(key_of_browser("ArrowUp"), Key::kForward);
  EXPECT_EQ(key_of_browser("ArrowDown"), Key::kBackward);
  EXPECT_EQ(key_of_browser("ArrowLeft"), Key::kTurnLeft);
  EXPECT_EQ(key_of_browser("ArrowRight"), Key::kTurnRight);
  EXPECT_EQ(key_of_browser("Enter"), Key::kGo);
  for (const char* none : {"", "W", "ww", "\n", "\x1B", "Escape", "arrowup", "F5"})
    EXPECT_EQ(key_of_browser(none), std::nullopt) << none;
}

// Every key of the terminal is offered to a page, once.
TEST(KeyHelp, OffersEveryKeyOfTheTerminal) {
  std::set<std::string> offered;
  for (const KeyHelp& row : key_help()) {
    ASSERT_FALSE(row.browser_keys.empty()) << row.name;
    for (const std::string& key : row.browser_keys) {
      EXPECT_TRUE(offered.insert(key).second) << key;
      ASSERT_TRUE(key_of_browser(key)) << key;
      EXPECT_EQ(name_of(*key_of_browser(key)), row.name);
    }
  }
  for (char letter = ' '; letter <= '~'; ++letter) {
    const std::string key(1, letter);
    EXPECT_EQ(!keys_of(key).empty(), offered.contains(key)) << key;
  }
}

TEST(KeyQueue, KeepsTheOrderAndDropsWhatItCannotHold) {
  KeyQueue queue;
  EXPECT_EQ(queue.pop(), std::nullopt);
  for (int round = 0; round < 3; ++round) {
    for (std::size_t i = 0; i < KeyQueue::kCapacity; ++i)
      EXPECT_TRUE(queue.push(i == 1 ? Key::kGo : Key::kStop));
    EXPECT_FALSE(queue.push(Key::kEnd));
    for (std::size_t i = 0; i < KeyQueue::kCapacity; ++i)
      EXPECT_EQ(queue.pop(), i == 1 ? Key::kGo : Key::kStop);
    EXPECT_EQ(queue.pop(), std::nullopt);
  }
}

TEST(PageKeys, GoIntoTheQueue) {
  KeyQueue queue;
  const view::PageKeys keys = page_keys(queue);
  using Answer = view::PageKeys::Answer;
  EXPECT_EQ(keys.press("ArrowUp"), Answer::kTaken);
  EXPECT_EQ(keys.press("nonsense"), Answer::kUnknown);
  EXPECT_EQ(queue.pop(), Key::kForward);
  EXPECT_EQ(queue.pop(), std::nullopt);
  for (std::size_t i = 0; i < KeyQueue::kCapacity; ++i) EXPECT_EQ(keys.press("w"), Answer::kTaken);
  EXPECT_EQ(keys.press("w"), Answer::kBusy);
}

}  // namespace
}  // namespace koboshi::tools
