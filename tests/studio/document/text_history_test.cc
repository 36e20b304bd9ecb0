#include "studio/document/text_history.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/support/seed.h"

namespace koboshi::studio {
namespace {

// A text with its history, as a document has them.
struct Editor {
  std::string text = "one two three";
  TextHistory history;

  void become(const std::string& next, std::string_view label, std::string_view drag = {}) {
    history.record(text, next, label, drag);
    text = next;
  }
};

TEST(TextHistory, UndoesAndRedoesWithLabels) {
  Editor editor;
  editor.become("one 2 three", "Second");
  editor.become("one 2 3", "Third");
  EXPECT_EQ(editor.history.undo_label(), "Third");
  EXPECT_TRUE(editor.history.undo(editor.text));
  EXPECT_EQ(editor.text, "one 2 three");
  EXPECT_EQ(editor.history.undo_label(), "Second");
  EXPECT_EQ(editor.history.redo_label(), "Third");
  EXPECT_TRUE(editor.history.undo(editor.text));
  EXPECT_EQ(editor.text, "one two three");
  EXPECT_FALSE(editor.history.undo(editor.text));
  EXPECT_TRUE(editor.history.redo(editor.text));
  editor.become("1 2 three", "First");
  EXPECT_FALSE(editor.history.can_redo());
}

TEST(TextHistory, MergesTheEditsOfADrag) {
  Editor editor;
  for (const char* next : {"one 2 three", "one 22 three", "one 222 three!"})
    editor.become(next, "Drag", "joint");
  EXPECT_EQ(editor.history.undo_count(), 1U);
  editor.history.end_merge();
  editor.become("one 4 three", "Drag", "joint");
  EXPECT_EQ(editor.history.undo_count(), 2U);
  editor.become("one 5 three", "Drag", "other joint");
  EXPECT_EQ(editor.history.undo_count(), 3U);
  for (int i = 0; i < 2; ++i) editor.history.undo(editor.text);
  EXPECT_EQ(editor.text, "one 222 three!");
  editor.history.undo(editor.text);
  EXPECT_EQ(editor.text, "one two three");
}

TEST(TextHistory, ForgetsADragThatEndsWhereItBegan) {
  Editor editor;
  editor.become("one 2 three", "Drag", "joint");
  editor.become("one two three", "Drag", "joint");
  EXPECT_FALSE(editor.history.can_undo());
  EXPECT_TRUE(editor.history.is_saved());
  EXPECT_EQ(editor.history.bytes(), 0U);
}

TEST(TextHistory, KnowsWhichTextIsThatOfTheFile) {
  Editor editor;
  EXPECT_TRUE(editor.history.is_saved());
  editor.become("a", "A", "drag");
  EXPECT_FALSE(editor.history.is_saved());
  editor.history.mark_saved();
  editor.become("ab", "A", "drag");  // a saved text is not merged away
  EXPECT_EQ(editor.history.undo_count(), 2U);
  editor.history.undo(editor.text);
  EXPECT_TRUE(editor.history.is_saved());
  editor.history.undo(editor.text);
  editor.become("c", "C");  // the saved text is beyond reach
  editor.history.undo(editor.text);
  EXPECT_FALSE(editor.history.is_saved());
  editor.history.redo(editor.text);
  EXPECT_FALSE(editor.history.is_saved());
}

TEST(TextHistory, ForgetsTheOldestBeyondItsMemory) {
  TextHistory history(4'000);
  std::string text;
  history.record(text, "begun", "Begin");
  text = "begun";
  history.undo(text);
  history.redo(text);
  for (int i = 0; i < 100; ++i) {
    const std::string next(300, static_cast<char>('a' + i % 26));
    history.record(text, next, "Fill");
    text = next;
    EXPECT_LE(history.bytes(), 4'000U);
  }
  EXPECT_GE(history.undo_count(), 3U);
  EXPECT_LT(history.undo_count(), 20U);
  history.record(text, std::string(9'000, 'x'), "More than all memory");
  text = std::string(9'000, 'x');
  EXPECT_EQ(history.undo_count(), 1U);
  while (history.undo(text)) EXPECT_FALSE(history.is_saved());
}

TEST(TextHistory, LeadsBackToTheFirstTextToTheByte) {
  std::mt19937 random(static_cast<std::uint32_t>(test::kSeed));
  const std::string first = "some text to begin with";
  Editor editor{.text = first, .history = TextHistory()};
  std::vector<std::string> texts{first};
  for (int i = 0; i < 300; ++i) {
    std::string next = editor.text;
    next.replace(random() % (next.size() + 1), random() % 4, std::string(random() % 5, "abc"[random() % 3]));
    if (next == editor.text) continue;
    editor.become(next, "Random");
    texts.push_back(next);
  }
  for (std::size_t i = texts.size() - 1; i-- > 0;) {
    ASSERT_TRUE(editor.history.undo(editor.text));
    ASSERT_EQ(editor.text, texts[i]);
  }
  for (std::size_t i = 1; i < texts.size(); ++i) {
    ASSERT_TRUE(editor.history.redo(editor.text));
    ASSERT_EQ(editor.text, texts[i]);
  }
}

}  // namespace
}  // namespace koboshi::studio
