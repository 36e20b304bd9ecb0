#include "studio/run/inbox.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace koboshi::studio {
namespace {

TEST(Inbox, PutsEventsInOrderOfTime) {
  Inbox inbox;
  inbox.set_events({{2'013'000, "state", "standing"},
                    {2'000'000, "command", "enable"},
                    {2'013'000, "can", "left_knee: operational"},
                    {500'000, "state", "limp"}});
  view::Recording recording;
  append(inbox.take(), recording);
  std::vector<std::string> texts;
  for (const view::Event& event : recording.events) texts.push_back(event.text);
  EXPECT_EQ(texts, (std::vector<std::string>{"limp", "enable", "standing", "left_knee: operational"}));
}

// The events of the run may come later than the rewind: until then, those of the future are gone as well.
TEST(Inbox, ARewindForgetsTheEventsOfTheFuture) {
  const std::vector<view::Event> events{{1'000'000, "state", "standing"}, {3'000'000, "state", "walking"}};
  const auto texts = [](const view::Recording& recording) {
    std::vector<std::string> all;
    for (const view::Event& event : recording.events) all.push_back(event.text);
    return all;
  };
  const std::vector<std::string> past{"standing"};
  view::Recording taken;
  Inbox inbox;
  inbox.set_events(events);
  append(inbox.take(), taken);
  inbox.rewind({2'000'000, 2'000'000});
  append(inbox.take(), taken);
  EXPECT_EQ(texts(taken), past);

  view::Recording waiting;  // the events were still in the inbox
  inbox.set_events(events);
  inbox.rewind({2'000'000, 2'000'000});
  append(inbox.take(), waiting);
  EXPECT_EQ(texts(waiting), past);
}

}  // namespace
}  // namespace koboshi::studio
