#include "view/replay/replay_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string_view>

#include "tests/support/walking_recording.h"
#include "view/render/looks.h"
#include "view/replay/column_pack.h"
#include "view/replay/replay_data.h"

namespace koboshi::view {
namespace {

using nlohmann::ordered_json;
using testing::HasSubstr;

// Header and columns of a page's data.
struct Data {
  explicit Data(const std::string& data) {
    std::uint32_t size = 0;
    for (std::size_t i = 4; i-- > 0;) size = size << 8 | static_cast<unsigned char>(data[i]);
    header = ordered_json::parse(data.substr(4, size));
    bytes = data.substr(4 + size);
  }
  std::vector<double> column(const ordered_json& column) const { return unpack(column, bytes); }

  ordered_json header;
  std::string bytes;
};

TEST(ReplayData, PosesAreWithinTheirQuantum) {
  const Recording recording = walking_recording();
  const Data data(replay_data(recording, nullptr, {}));
  const ordered_json& poses = data.header["run"]["poses"];
  ASSERT_EQ(poses.size(), recording.scene.links.size());
  for (std::size_t link = 0; link < poses.size(); ++link) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto column = data.column(poses[link]["position"][static_cast<std::size_t>(axis)]);
      ASSERT_EQ(column.size(), recording.samples.size());
      for (std::size_t i = 0; i < column.size(); ++i) {
        EXPECT_NEAR(column[i], static_cast<double>(recording.samples[i].links[link].p_WL_m[axis]),
                    0.501 * kPositionQuantum_m);
      }
    }
  }
}

TEST(ReplayData, QuaternionsThatChangeTheirSignGoOnSmoothly) {
  Recording recording = walking_recording({.duration_s = 1.0});
  for (std::size_t i = 0; i < recording.samples.size(); i += 2)
    recording.samples[i].links[0].q_WL.coeffs() *= -1.0F;
  const Data data(replay_data(recording, nullptr, {}));
  const auto w = data.column(data.header["run"]["poses"][0]["quaternion"][3]);
  for (std::size_t i = 1; i < w.size(); ++i) EXPECT_NEAR(w[i], w[i - 1], 1e-3);
}

TEST(ReplayData, FramesComeBackWithAllTheirBytes) {
  const Recording recording = walking_recording({.duration_s = 1.6});
  const Data data(replay_data(recording, nullptr, walking_network()));
  const ordered_json& frames = data.header["run"]["frames"];
  const auto times = data.column(frames["times"]);
  const auto groups = data.column(frames["group"]);
  ASSERT_EQ(times.size(), recording.frames.size());
  std::map<std::size_t, std::size_t> next;  // frame of each group
  for (std::size_t i = 0; i < times.size(); ++i) {
    const hal::CanFrame& frame = recording.frames[i].frame;
    const auto index = static_cast<std::size_t>(groups[i]);
    const ordered_json& group = frames["groups"][index];
    ASSERT_EQ(group["identifier"], frame.identifier);
    ASSERT_EQ(times[i], static_cast<double>(recording.frames[i].end_us));
    const std::size_t ordinal = next[index]++;
    for (std::size_t byte = 0; byte < frame.size; ++byte)
      ASSERT_EQ(data.column(group["bytes"][byte])[ordinal], frame.data[byte]);
  }
}

TEST(ReplayData, DescribesFramesOfServices) {
  const Data data(replay_data(walking_recording({.duration_s = 1.6}), nullptr, walking_network()));
  const ordered_json& frames = data.header["run"]["frames"];
  const std::string texts = frames["texts"].dump();
  for (const char* text :
       {"NMT all nodes: ", "SDO node 16: write 1016:01 Consumer heartbeat time 1 = 0x000101F4",
        "EMCY node 16: 8110", "heartbeat node 16: operational"}) {
    EXPECT_THAT(texts, HasSubstr(text));
  }
  for (const ordered_json& group : frames["groups"])
    EXPECT_EQ(group.contains("texts"), group["kind"] != "PDO");
}

hal::CanFrame write_request(std::uint16_t node, std::array<std::uint8_t, 8> data) {
  return {.identifier = static_cast<std::uint16_t>(0x600 + node), .size = 8, .data = data};
}

TEST(ReplayData, NamesTheObjectsOfControllerDrivesAndSensors) {
  Recording recording = walking_recording({.duration_s = 0.1});
  recording.frames = {{1'000, write_request(1, {0x2B, 0x11, 0x21, 0x01, 0x64, 0x00})},
                      {2'000, write_request(16, {0x2F, 0x60, 0x60, 0x00, 0x08})},
                      {3'000, write_request(36, {0x2B, 0x17, 0x10, 0x00, 0x64, 0x00})},
                      {4'000, write_request(16, {0x2F, 0x00, 0x5F, 0x00, 0x08})}};
  const Data data(replay_data(recording, nullptr, {}));
  const std::string texts = data.header["run"]["frames"]["texts"].dump();
  for (const char* text :
       {"SDO node 1: write 2111:01 Highest velocity forward = 0x0064",
        "SDO node 16: write 6060:00 Modes of operation = 0x08",
        "SDO node 36: write 1017:00 Producer heartbeat time = 0x0064", "SDO node 16: write 5F00:00 = 0x08"}) {
    EXPECT_THAT(texts, HasSubstr(text));
  }
}

TEST(ReplayPage, NodesHaveTheNamesOfTheRecording) {
  const bus::Network known = walking_network();
  Recording recording = walking_recording({.duration_s = 0.1});
  EXPECT_EQ(network_of(recording, known).messages.size(), known.messages.size()) << "no nodes recorded";
  recording.nodes = {{1, "controller"}, {16, known.nodes[1].name}};
  ASSERT_EQ(known.nodes[1].node_id, 16);
  EXPECT_EQ(network_of(recording, known).messages.size(), known.messages.size());
  recording.nodes[1].name = "tail";
  const bus::Network other = network_of(recording, known);
  ASSERT_EQ(other.nodes.size(), 2U);
  EXPECT_EQ(other.nodes[1].name, "tail");
  EXPECT_TRUE(other.messages.empty()) << "whose factors are those of another robot's drives";
}

TEST(ReplayData, EqualMeshesAreStoredOnce) {
  Recording recording = walking_recording({.duration_s = 0.1});
  Shape second = recording.scene.links[1].visuals[0];
  second.X_LG.translation().x() += 0.1;
  recording.scene.links[0].visuals.push_back(second);
  std::get<Mesh>(second.geometry).vertices_m[0].x() += 0.1F;
  recording.scene.links[0].visuals.push_back(second);
  const ordered_json links = Data(replay_data(recording, nullptr, {})).header["run"]["scene"]["links"];
  const ordered_json& head = links[1]["visuals"][0]["mesh"];
  EXPECT_EQ(links[0]["visuals"][1]["mesh"], head);
  EXPECT_NE(links[0]["visuals"][2]["mesh"], head);
}

TEST(ReplayData, ASecondRunBringsTheFirstDifference) {
  const Recording one = walking_recording();
  const Recording other = walking_recording({.stumbles_at_s = 1.0});
  EXPECT_FALSE(Data(replay_data(one, &one, {})).header.contains("first_difference"));
  const Data data(replay_data(one, &other, {}));
  EXPECT_EQ(data.header["first_difference"]["time"], 1'000'000);
  EXPECT_THAT(data.header["first_difference"]["text"].get<std::string>(), HasSubstr("true_pitch is "));
}

TEST(ReplayPage, ContainsNoTextOfTheRunUnescaped) {
  const std::string page = replay_page(walking_recording({.duration_s = 0.1}), nullptr, walking_network());
  EXPECT_NE(page.find("<title>sample &lt;/script&gt;&lt;b&gt;walk&lt;/b&gt; &amp; \"quotes\""),
            std::string::npos);
  EXPECT_EQ(page.find("injected"), std::string::npos);
  std::size_t scripts = 0;
  for (std::size_t at = page.find("</script"); at != std::string::npos; at = page.find("</script", at + 1))
    ++scripts;
  EXPECT_EQ(scripts, 3U);  // data, three.js, the page's own
}

TEST(ReplayPage, LoadsNothingAndNamesTheLicence) {
  const std::string page = replay_page(walking_recording({.duration_s = 0.1}), nullptr, walking_network());
  // Not HasSubstr, which would print the page.
  const auto contains = [&](std::string_view text) { return page.find(text) != std::string::npos; };
  EXPECT_TRUE(contains("Content-Security-Policy\" content=\"default-src 'none'"));
  for (const char* attribute : {"src=\"", "href=\"http", "@import", "url("}) {
    const std::string_view head = std::string_view(page).substr(0, page.find("<script"));
    EXPECT_EQ(head.find(attribute), std::string_view::npos) << attribute;
  }
  EXPECT_TRUE(contains("2010-2019 three.js authors"));
  EXPECT_TRUE(contains("Permission is hereby granted"));
  EXPECT_TRUE(contains("OrbitControls"));
}

// One minute: 100 ticks/s with 147 signals, 4,900 frames/s.
TEST(ReplayPage, AMinuteTakesAtMostEightMegabytes) {
  const Recording minute = walking_recording({.duration_s = 60.0, .signals = 133, .drives = 48});
  ASSERT_EQ(minute.signals.size(), 147U);
  ASSERT_GE(minute.frames.size(), 290'000U);
  const std::size_t bytes = replay_page(minute, nullptr, walking_network()).size();
  EXPECT_LT(bytes, 8'000'000U);
  EXPECT_GT(bytes, 2'000'000U) << "the sample's noise cannot be that small";
}

// Keys, directions and colours are those of the studio and of films.
TEST(ReplayPage, HasTheLooksOfTheStudio) {
  const std::string page = replay_page(walking_recording({.duration_s = 0.1}), nullptr, {});
  const std::string begin = "const LOOKS = ";
  const std::size_t at = page.find(begin) + begin.size();
  const auto looks = ordered_json::parse(page.substr(at, page.find(";\n", at) - at));
  ASSERT_EQ(looks["views"].size(), kNamedViews.size());
  for (std::size_t i = 0; i < kNamedViews.size(); ++i) {
    EXPECT_EQ(looks["views"][i]["key"], std::string(1, kNamedViews[i].key));
    EXPECT_EQ(looks["views"][i]["azimuth_deg"], kNamedViews[i].azimuth_deg);
    EXPECT_EQ(looks["views"][i]["elevation_deg"], kNamedViews[i].elevation_deg);
  }
  for (const SharedKey& shared : kSharedKeys)
    EXPECT_EQ(looks["keys"][std::string(shared.action)], std::string(shared.key));
  EXPECT_EQ(looks["colours"]["left"], "#009e73");
  EXPECT_EQ(looks["colours"]["right"], "#cc79a7");
  EXPECT_EQ(looks["colours"]["planned"], "#d55e00");
}

}  // namespace
}  // namespace koboshi::view
