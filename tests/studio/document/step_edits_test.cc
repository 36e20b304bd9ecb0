#include <gtest/gtest.h>

#include <functional>

#include "tests/studio/document/sample_document.h"

namespace koboshi::studio {
namespace {

using enum StepPlace::Kind;
using Rows = std::vector<std::size_t>;

// Checks the text after one edit of the sample, and that it can be undone and redone.
void expect_change(const std::function<void(MotionDocument&)>& edit, const std::string& expected) {
  const auto document = document_of();
  edit(*document);
  expect_edit(*document, expected);
}

TEST(TimeEdits, ChangeOneValueInPlace) {
  expect_change([](auto& motion) { motion.set_time(Rows{0}, 2.25049); },
                with("time_s: 1.5}   # slowly", "time_s: 2.25}   # slowly"));
  expect_change(
      [](auto& motion) {
        motion.set_time(Rows{1, 3}, 0.75);
      },
      with("wait_s: 0.5", "wait_s: 0.75", with("speed_deg_per_s: 90", "time_s: 0.75")));
  expect_change([](auto& motion) { motion.set_speed(Rows{0}, 45); },
                with("time_s: 1.5", "speed_deg_per_s: 45"));
  expect_change(
      [](auto& motion) {
        motion.set_pause(Rows{4, 0, 4, 0}, 0.2);
      },
      with("pause_s: 0.1", "pause_s: 0.2", with("time_s: 1.5}", "time_s: 1.5, pause_s: 0.2}")));
  expect_change([](auto& motion) { motion.set_pause(Rows{4}, 0); }, with(", pause_s: 0.1", ""));
  expect_change([](auto& motion) { motion.set_interpolation(Rows{3}, {}); },
                with(", interpolation: minimum_jerk", ""));
  expect_change([](auto& motion) { motion.set_interpolation(Rows{4}, motion::Interpolation::kCubic); },
                with("pause_s: 0.1}", "pause_s: 0.1, interpolation: cubic}"));
  expect_change([](auto& motion) { motion.set_value(2, "loop.times", "5"); }, with("times: 3", "times: 5"));
  expect_change([](auto& motion) { motion.erase_value(4, "pause_s"); }, with(", pause_s: 0.1", ""));
}

// A move has one of time, speed and least time; an edit puts the new one in the place of the old one.
TEST(TimeEdits, KeepALeastTimeUntilASpeedReplacesIt) {
  const std::string least = with("{pose: stand, time_s: 1.5}", "{pose: stand, at_least_s: 0.02}");
  const auto edited = [&](auto&& edit) {
    const auto document = document_of(least);
    edit(*document);
    return document->text();
  };
  EXPECT_EQ(edited([](auto& motion) { motion.set_time(Rows{0}, 0.5); }),
            with("at_least_s: 0.02", "at_least_s: 0.5", least));
  EXPECT_EQ(edited([](auto& motion) { motion.set_speed(Rows{0}, 90); }),
            with("at_least_s: 0.02", "speed_deg_per_s: 90", least));
  EXPECT_EQ(edited([](auto& motion) { motion.scale_time(Rows{0}, 2); }),
            with("at_least_s: 0.02", "at_least_s: 0.04", least));
  // From the standing pose the elbows turn by 20 degrees, at 7.48 rad/s.
  EXPECT_NEAR(document_of(least)->rows().rows[0].duration_s, 20.0 * kDegree / 7.48, 1e-4);
  const std::string slow = with("{pose: stand, time_s: 1.5}", "{pose: stand, at_least_s: 1.5}");
  EXPECT_NEAR(document_of(slow)->rows().rows[0].duration_s, 1.5, 1e-9);
}

TEST(TimeEdits, ScaleRowsWithTheirBodies) {
  expect_change(
      [](auto& motion) {
        motion.scale_time(Rows{1, 2}, 2);
      },
      with("wait_s: 0.5", "wait_s: 1",
           with("speed_deg_per_s: 90", "speed_deg_per_s: 45",
                with("time_s: 0.3, pause_s: 0.1", "time_s: 0.6, pause_s: 0.2"))));
}

TEST(TimeEdits, RefuseWhatDoesNotFitAndChangeNothing) {
  const auto document = document_of();
  EXPECT_THROW(document->set_time(Rows{0, 1}, 61), InputError);
  EXPECT_THROW(document->set_time(Rows{0, 1}, 0), InputError);
  EXPECT_THROW(document->set_time(Rows{0, 8}, 1), InputError);  // a jump
  EXPECT_THROW(document->set_speed(Rows{0, 1}, 1), InputError);
  EXPECT_THROW(document->set_pause(Rows{1}, 1), InputError);
  EXPECT_THROW(document->scale_time(Rows{0}, 0), InputError);
  EXPECT_THROW(document->scale_time(Rows{0}, 1e5), InputError);
  EXPECT_THROW(document->set_value(0, "time_s.more", "1"), InputError);
  EXPECT_EQ(document->text(), kSample);
  const std::string old =
      "version: 1\nrobot: koboshi\nname: a\nposes:\n  p: {knee: 5}\n"
      "steps:\n  - {pose: p, time_s: 1}\n";
  const auto version_1 = document_of(old);
  EXPECT_THROW(version_1->set_pause(Rows{0}, 1), InputError);
  version_1->upgrade();
  version_1->set_pause(Rows{0}, 1);
  EXPECT_NE(version_1->compiled(), nullptr);
}

TEST(StepEdits, InsertAtEachPlace) {
  const auto document = document_of();
  EXPECT_EQ(document->insert_step({kBefore, 0}, "{wait_s: 9}"), 0U);
  expect_edit(*document, with("  # get ready", "  - {wait_s: 9}\n  # get ready"));
  expect_change(
      [](auto& motion) {
        EXPECT_EQ(motion.insert_step({kAfter, 2}, "{wait_s: 9}"), 5U);
      },
      with("  - if:", "  - {wait_s: 9}\n  - if:"));
  expect_change(
      [](auto& motion) {
        EXPECT_EQ(motion.insert_step({kInto, 2}, "{wait_s: 9}"), 5U);
      },
      with("  - if:", "        - {wait_s: 9}\n  - if:"));
  expect_change(
      [](auto& motion) {
        EXPECT_EQ(motion.insert_step({kInto, 5}, "{wait_s: 9}"), 7U);
      },
      with("    else:", "      - {wait_s: 9}\n    else:"));
  expect_change(
      [](auto& motion) {
        motion.insert_step({kIntoElse, 5}, "{wait_s: 9}");
      },
      with("  # the end", "      - {wait_s: 9}\n  # the end"));
  expect_change(
      [](auto& motion) {
        EXPECT_EQ(motion.insert_step({kEndOf, 0}, "end"), 10U);
      },
      kSample + "  - end\n");
  expect_change(
      [](auto& motion) {
        EXPECT_EQ(motion.insert_step({kEndOf, 1}, "return"), 12U);
      },
      with("\nsteps:\n  # get", "\n    - return\nsteps:\n  # get"));
}

TEST(StepEdits, InsertABlock) {
  const std::string block =
      "- if: pitch_mdeg > 0   # forward\n  then:\n    - {wait_s: 1}\n- loop:\n    times: 2\n    steps: []\n";
  const auto document = document_of();
  EXPECT_EQ(document->insert_step({kAfter, 1}, block), 2U);
  EXPECT_EQ(document->text(),
            with("  - loop:",
                 "  - if: pitch_mdeg > 0   # forward\n    then:\n      - {wait_s: 1}\n  - loop:\n"
                 "      times: 2\n      steps: []\n  - loop:"));
  // An empty body becomes a block, a missing else as well.
  EXPECT_EQ(document->insert_step({kInto, 4}, "{wait_s: 2}"), 5U);
  EXPECT_NE(document->text().find("      steps:\n        - {wait_s: 2}\n"), std::string::npos);
  EXPECT_EQ(document->insert_step({kIntoElse, 2}, "{wait_s: 3}"), 4U);
  EXPECT_NE(document->text().find("    else:\n      - {wait_s: 3}\n"), std::string::npos) << document->text();
  for (int i = 0; i < 3; ++i) document->undo();
  EXPECT_EQ(document->text(), kSample);
}

TEST(StepEdits, EraseRowsButNoComment) {
  expect_change([](auto& motion) { motion.erase_rows(Rows{0}); },
                with("  - {pose: stand, time_s: 1.5}   # slowly\n", ""));
  expect_change(
      [](auto& motion) {
        motion.erase_rows(Rows{9, 1, 3});
      },
      with("  - {wait_s: 0.5}\n", "",
           with("        - {pose: wave, speed_deg_per_s: 90, interpolation: minimum_jerk}\n", "",
                with("  - {label: done}\n", ""))));
  expect_change(
      [](auto& motion) {
        motion.erase_rows(Rows{3, 4});
      },
      with("      steps:\n", "      steps: []\n",
           with("        - {pose: wave, speed_deg_per_s: 90, interpolation: minimum_jerk}\n"
                "        - {pose: stand, time_s: 0.3, pause_s: 0.1}\n",
                "")));
}

TEST(StepEdits, EraseEveryRowAndInsertAgain) {
  const auto document = document_of();
  document->erase_rows(Rows{0, 1, 2, 5, 8, 9});
  EXPECT_EQ(document->rows().sections[0].row_count, 0U);
  EXPECT_NE(document->text().find("steps: []\n  # get ready\n"), std::string::npos) << document->text();
  EXPECT_EQ(document->insert_step({kEndOf, 0}, "{wait_s: 1}"), 0U);
  EXPECT_NE(document->text().find("steps:\n  - {wait_s: 1}\n"), std::string::npos) << document->text();
  document->undo();
  document->undo();
  EXPECT_EQ(document->text(), kSample);
}

TEST(StepEdits, DuplicateRowsBehindTheLast) {
  const auto document = document_of();
  EXPECT_EQ(document->duplicate_rows(Rows{0, 1}), 2U);
  expect_edit(*document, with("  - {wait_s: 0.5}\n",
                              "  - {wait_s: 0.5}\n  # get ready\n  - {pose: stand, time_s: 1.5}   # slowly\n "
                              " - {wait_s: 0.5}\n"));
}

TEST(StepEdits, MoveRowsWithTheirComments) {
  const std::string first = "  # get ready\n  - {pose: stand, time_s: 1.5}   # slowly\n";
  expect_change(
      [](auto& motion) {
        EXPECT_EQ(motion.move_rows(Rows{0}, {kAfter, 1}), 1U);
      },
      with("  - {wait_s: 0.5}\n", "  - {wait_s: 0.5}\n" + first, with(first, "")));
  const std::string deeper = "        # get ready\n        - {pose: stand, time_s: 1.5}   # slowly\n";
  expect_change(
      [](auto& motion) {
        EXPECT_EQ(motion.move_rows(Rows{0}, {kInto, 2}), 4U);
      },
      with("  - if:", deeper + "  - if:", with(first, "")));
  const std::string wave = "- {pose: wave, speed_deg_per_s: 90, interpolation: minimum_jerk}\n";
  const std::string inside = "        # out\n        " + wave;
  expect_change(
      [](auto& motion) {
        EXPECT_EQ(motion.move_rows(Rows{3}, {kBefore, 0}), 0U);
      },
      with("  # get ready\n", "  # out\n  " + wave + "  # get ready\n", with(inside, "")));
}

TEST(StepEdits, KeepCommentsThatBelongToNoStep) {
  const std::string head = "version: 2\nrobot: koboshi\nname: r\nsteps:\n";
  const std::string text = head +
                           "    # about all\n\n    - {wait_s: 1}\n\n    # between\n\n    - {wait_s: 2}\n"
                           "      # deeper\n    - {wait_s: 3}\n";
  const auto document = document_of(text);
  document->move_rows(Rows{0, 1}, {kAfter, 2});
  expect_edit(*document,
              head +
                  "    # about all\n\n    - {wait_s: 3}\n    - {wait_s: 1}\n\n    # between\n\n"
                  "    - {wait_s: 2}\n      # deeper\n",
              text);
  const auto reversed = document_of(text);
  reversed->reverse_rows(Rows{0, 1, 2});
  expect_edit(*reversed,
              head +
                  "    # about all\n\n    - {wait_s: 3}\n\n    # between\n\n    - {wait_s: 2}\n"
                  "      # deeper\n    - {wait_s: 1}\n",
              text);
}

TEST(StepEdits, RefuseToMoveALoopIntoItself) {
  const auto document = document_of();
  EXPECT_THROW(static_cast<void>(document->move_rows(Rows{2}, {kInto, 2})), InputError);
  EXPECT_THROW(static_cast<void>(document->move_rows(Rows{2, 0}, {kAfter, 3})), InputError);
  EXPECT_THROW(static_cast<void>(document->insert_step({kInto, 0}, "end")), InputError);
  EXPECT_THROW(static_cast<void>(document->insert_step({kAfter, 0}, "{a: ")), InputError);
  EXPECT_THROW(static_cast<void>(document->insert_step({kAfter, 0}, "a: 1\nb: 2")), InputError);
  EXPECT_THROW(static_cast<void>(document->insert_step({kEndOf, 7}, "end")), InputError);
  EXPECT_THROW(document->erase_rows(Rows{}), InputError);
  EXPECT_EQ(document->text(), kSample);
  EXPECT_FALSE(document->history().can_undo());
}

TEST(StepEdits, LeaveNothingOfAnEditThatIsRefusedHalfway) {
  const std::string text = with("    else:\n      - {call: nod}\n", "");
  const auto document = document_of(text);
  EXPECT_THROW(static_cast<void>(document->move_rows(Rows{5}, {kIntoElse, 5})), InputError);
  document->set_time(Rows{1}, 2);
  EXPECT_EQ(document->text(), with("wait_s: 0.5", "wait_s: 2", text));
}

TEST(StepEdits, ReverseTheOrderAndKeepTransitionsWithTheirPoses) {
  const std::string text =
      "version: 2\nrobot: koboshi\nname: r\nposes:\n  a: {head_pan: 1}\n  b: {head_pan: 2}\n"
      "  c: {head_pan: 3}\nsteps:\n"
      "  - {pose: a, time_s: 1}\n"
      "  # over b\n  - {pose: b, time_s: 2, interpolation: cubic}   # b\n"
      "  - {wait_s: 0.5}\n"
      "  - {pose: c, speed_deg_per_s: 3, pause_s: 4}\n";
  const auto document = document_of(text);
  document->reverse_rows(Rows{0, 1, 2, 3});
  // c comes first, as a did; from c back to b at the speed of b to c, from b to a as from a to b.
  expect_edit(*document,
              text.substr(0, text.find("  - {pose: a")) +
                  "  - {pose: c, time_s: 1, pause_s: 4}\n"
                  "  - {wait_s: 0.5}\n"
                  "  # over b\n  - {pose: b, speed_deg_per_s: 3}   # b\n"
                  "  - {pose: a, time_s: 2, interpolation: cubic}\n",
              text);
  EXPECT_THROW(document_of()->reverse_rows(Rows{0, 1, 2}), InputError);  // a loop
  EXPECT_THROW(document->reverse_rows(Rows{0, 2}), InputError);
}

}  // namespace
}  // namespace koboshi::studio
