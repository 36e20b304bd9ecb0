#include "tools/studio/run/inbox.h"

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

}  // namespace
}  // namespace koboshi::studio
