#include "tools/run/live_link.h"

#include <gtest/gtest.h>

#include <csignal>
#include <optional>
#include <stdexcept>

#include "tests/unit/base/scratch_file.h"
#include "tests/unit/sim_board/can/bus_fixture.h"
#include "tests/unit/sim_board/can/transport/outside.h"

namespace koboshi::tools {
namespace {

class LiveLinkTest : public testing::Test {
 protected:
  // A second of the simulation in a hundredth of the wall's, and no longer.
  static constexpr double kSpeed = 100.0;

  void play(LiveLink& link, std::uint64_t end_us) {
    link.attach(bus_);
    for (std::uint64_t now_us = 0; now_us < end_us; now_us += 1'000) {
      link.before(now_us);
      ASSERT_TRUE(bus_.queue(handle_, {.identifier = 0x123, .size = 0}, now_us));
      bus_.advance_to(now_us + 1'000);
      link.after(now_us + 1'000);
    }
  }
  // Within as many asks as a twentieth of a second of simulation has.
  static bool is_interrupted(LiveLink& link) {
    for (int i = 0; i < 50; ++i) {
      if (link.interrupted()) return true;
    }
    return false;
  }

  sim_board::test::ListeningNode inside_;
  sim_board::test::ListeningNode another_;  // acknowledges
  sim_board::Bus bus_;
  sim_board::NodeHandle handle_ = bus_.attach(inside_, sim_board::AcceptanceFilter::all(), 4);
  sim_board::NodeHandle other_handle_ = bus_.attach(another_, sim_board::AcceptanceFilter::all(), 4);
};

TEST_F(LiveLinkTest, IsOffByDefault) {
  LiveLink link({});
  play(link, 10'000);
  EXPECT_FALSE(link.is_live());
  EXPECT_EQ(link.transport(), nullptr);
  EXPECT_TRUE(link.report().is_null());
  EXPECT_FALSE(is_interrupted(link));
}

// A signal ends the wait for the clock, which would take 100 s here.
TEST_F(LiveLinkTest, IsInterruptedWhileItWaits) {
  LiveLink link({.realtime = true, .speed = 0.01});
  link.attach(bus_);
  raise(SIGINT);
  link.after(1'000'000);
  EXPECT_TRUE(is_interrupted(link));
}

TEST_F(LiveLinkTest, CountsTransmittedFrames) {
  const ScratchFile log("log", "");
  LiveLink link({.can = "log:" + log.path().string()});
  play(link, 10'000);
  EXPECT_FALSE(link.is_live());
  EXPECT_EQ(link.report(), (nlohmann::ordered_json{{"can",
                                                    {{"transport", log.path().string()},
                                                     {"frames_sent", 10},
                                                     {"frames_lost", 0},
                                                     {"frames_sent_late", 0},
                                                     {"frames_received", 0},
                                                     {"frames_refused", 0},
                                                     {"frames_dropped", 0},
                                                     {"frames_received_late", 0}}}}));
}

TEST_F(LiveLinkTest, FollowsTheClockOnRequest) {
  LiveLink link({.realtime = true, .speed = kSpeed});
  play(link, 100'000);
  EXPECT_TRUE(link.is_live());
  EXPECT_FALSE(link.report().contains("can"));
  EXPECT_TRUE(link.report().contains("overruns"));
  EXPECT_TRUE(link.report().contains("largest_delay_us"));
}

TEST_F(LiveLinkTest, FollowsTheClockWithALiveTransport) {
  LiveLink link({.can = "slcan", .speed = kSpeed});
  play(link, 100'000);
  EXPECT_TRUE(link.is_live());
  EXPECT_EQ(link.report()["can"]["frames_lost"], 100);  // no host has opened the channel
  EXPECT_TRUE(link.report().contains("overruns"));
}

TEST_F(LiveLinkTest, EndsOnASignalWithoutTheClock) {
  LiveLink link({});
  EXPECT_FALSE(is_interrupted(link));
  raise(SIGTERM);
  EXPECT_TRUE(is_interrupted(link));
}

// A machine that is too slow for what it carries, by a wall of the test's own.
class OverloadedLink : public LiveLinkTest {
 protected:
  OverloadedLink() {
    auto outside = std::make_unique<sim_board::test::Outside>();
    outside_ = outside.get();
    link_.emplace(LiveOptions{}, std::move(outside),
                  [this](const std::string& text) { warnings_.push_back(text); });
    link_->attach(bus_, {[this] { return wall_; }, [this](WallClock::Time due) { wall_ = due; }});
  }
  // `step` passes on the wall in each millisecond of the simulation.
  void play(int duration_ms, std::chrono::microseconds step) {
    for (int i = 0; i < duration_ms; ++i, now_us_ += 1'000) {
      link_->before(now_us_);
      outside_->said.push_back({.identifier = 0x321});
      ASSERT_TRUE(bus_.queue(handle_, {.identifier = 0x123}, now_us_));
      bus_.advance_to(now_us_ + 1'000);
      wall_ += step;
      link_->after(now_us_ + 1'000);
    }
  }

  WallClock::Time wall_{};
  std::uint64_t now_us_ = 0;
  std::vector<std::string> warnings_;
  sim_board::test::Outside* outside_ = nullptr;
  std::optional<LiveLink> link_;
};

TEST_F(OverloadedLink, WarnsWhenItFallsBehindAndCountsLateFrames) {
  play(100, std::chrono::microseconds(500));
  EXPECT_TRUE(warnings_.empty());
  EXPECT_EQ(link_->report()["can"]["frames_sent_late"], 0);
  play(100, std::chrono::milliseconds(2));  // it loses a millisecond in each
  EXPECT_TRUE(warnings_.empty());
  play(200, std::chrono::milliseconds(2));
  ASSERT_EQ(warnings_.size(), 1u) << "once";
  EXPECT_NE(warnings_[0].find("behind the clock"), std::string::npos);
  const auto report = link_->report();
  EXPECT_EQ(report["can"]["frames_sent_late"], 289);  // more than 10 ms, of 300
  EXPECT_EQ(report["can"]["frames_received_late"], 289);
  EXPECT_GE(report["largest_delay_us"], 299'000);
  play(1'000, std::chrono::microseconds(0));  // it catches up
  play(200, std::chrono::milliseconds(2));
  EXPECT_EQ(warnings_.size(), 2u) << "and once more when it begins anew";
}

TEST_F(OverloadedLink, WarnsOfLostFrames) {
  play(100, std::chrono::microseconds(500));
  outside_->full = true;
  outside_->lost_by_system = 3;
  play(200, std::chrono::microseconds(500));
  ASSERT_EQ(warnings_.size(), 2u);
  EXPECT_NE(warnings_[0].find("no room"), std::string::npos);
  EXPECT_NE(warnings_[1].find("faster"), std::string::npos);
  const auto report = link_->report();
  EXPECT_EQ(report["can"]["frames_dropped"], 3);
  EXPECT_GT(report["can"]["frames_lost"], 100);
}

// Ten frames of 111 bits and more in each millisecond: the bus takes nine at most. None is lost.
TEST_F(OverloadedLink, WarnsOfMoreFramesThanTheBusCarries) {
  for (int i = 0; i < 500; ++i) {
    outside_->said.insert(outside_->said.end(), 9, {.identifier = 0x321, .size = 8});
    play(1, std::chrono::microseconds(500));
  }
  ASSERT_EQ(warnings_.size(), 1u) << "once";
  EXPECT_NE(warnings_[0].find("late"), std::string::npos);
  const auto report = link_->report();
  EXPECT_GT(report["can"]["frames_received_late"], 1'000);
  EXPECT_EQ(report["can"]["frames_refused"], 0);
}

TEST_F(LiveLinkTest, EndsOnCtrlC) {
  LiveLink link({.realtime = true, .speed = kSpeed});
  EXPECT_FALSE(is_interrupted(link));
  raise(SIGINT);
  EXPECT_TRUE(is_interrupted(link));
}

TEST_F(LiveLinkTest, RefusesASpeedWithoutAClock) {
  EXPECT_THROW(LiveLink({.speed = 1.0}), std::invalid_argument);
  EXPECT_THROW(LiveLink({.can = "none", .speed = 0.5}), std::invalid_argument);
}

TEST_F(LiveLinkTest, RejectsAnUnknownTransport) {
  EXPECT_THROW(LiveLink({.can = "pigeon:1"}), std::invalid_argument);
}

}  // namespace
}  // namespace koboshi::tools
