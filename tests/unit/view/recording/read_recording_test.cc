#include "view/recording/read_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <set>
#include <string>

#include "base/text/error.h"
#include "tests/support/sample_recording.h"
#include "tests/support/seed.h"
#include "tests/support/temporary_folder.h"
#include "view/recording/recording_file.h"

namespace koboshi::view {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

bool same(const Pose& a, const Pose& b) { return a.p_WL_m == b.p_WL_m && a.q_WL.coeffs() == b.q_WL.coeffs(); }

bool same(const ContactForce& a, const ContactForce& b) {
  return a.link == b.link && a.other_link == b.other_link && a.p_W_m == b.p_W_m && a.f_W_N == b.f_W_N;
}

bool same(const Sample& a, const Sample& b) {
  const auto equal = [](const auto& x, const auto& y) { return same(x, y); };
  return a.time_us == b.time_us && a.values == b.values && std::ranges::equal(a.links, b.links, equal) &&
         std::ranges::equal(a.contacts, b.contacts, equal);
}

bool same(const Frame& a, const Frame& b) {
  return a.end_us == b.end_us && a.frame.identifier == b.frame.identifier && a.frame.size == b.frame.size &&
         a.frame.remote == b.frame.remote && a.frame.data == b.frame.data;
}

void expect_same(const Shape& a, const Shape& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_TRUE(a.X_LG.isApprox(b.X_LG, 1e-12));
  EXPECT_EQ(a.colour.red, b.colour.red);
  EXPECT_EQ(a.colour.blue, b.colour.blue);
  ASSERT_EQ(a.geometry.index(), b.geometry.index());
  if (const auto* box = std::get_if<Box>(&a.geometry)) {
    EXPECT_EQ(box->size_m, std::get<Box>(b.geometry).size_m);
  } else {
    EXPECT_EQ(std::get<Mesh>(a.geometry).vertices_m, std::get<Mesh>(b.geometry).vertices_m);
    EXPECT_EQ(std::get<Mesh>(a.geometry).triangles, std::get<Mesh>(b.geometry).triangles);
  }
}

void expect_same(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.robot, b.robot);
  ASSERT_EQ(a.links.size(), b.links.size());
  for (std::size_t i = 0; i < a.links.size(); ++i) {
    EXPECT_EQ(a.links[i].name, b.links[i].name);
    EXPECT_EQ(a.links[i].parent, b.links[i].parent);
    EXPECT_EQ(a.links[i].mass_kg, b.links[i].mass_kg);
    EXPECT_EQ(a.links[i].p_LCom_L, b.links[i].p_LCom_L);
    ASSERT_EQ(a.links[i].visuals.size(), b.links[i].visuals.size());
    expect_same(a.links[i].visuals[0], b.links[i].visuals[0]);
    ASSERT_EQ(a.links[i].collisions.size(), b.links[i].collisions.size());
    expect_same(a.links[i].collisions[0], b.links[i].collisions[0]);
  }
  ASSERT_EQ(a.planes.size(), b.planes.size());
  EXPECT_EQ(a.planes[0].normal_W, b.planes[0].normal_W);
  ASSERT_EQ(a.ground.size(), b.ground.size());
  expect_same(a.ground[0], b.ground[0]);
  EXPECT_EQ(a.soles_L, b.soles_L);
  EXPECT_EQ(a.sole_links, b.sole_links);
}

// Whether the parts that grow with time are the first ones of the whole recording's.
bool is_prefix(const Recording& part, const Recording& whole) {
  const auto begins = [](const auto& list, const auto& all) {
    return list.size() <= all.size() &&
           std::equal(list.begin(), list.end(), all.begin(), [](auto& a, auto& b) { return same(a, b); });
  };
  return begins(part.samples, whole.samples) && begins(part.frames, whole.frames) &&
         part.events.size() <= whole.events.size() && part.pushes.size() <= whole.pushes.size();
}

class ReadRecording : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& bytes) const {
    test::write_file(file_, bytes);
    return file_;
  }
  std::string bytes_of(const Recording& recording) const {
    write_recording(file_, recording);
    return test::read_file(file_);
  }

  const test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_.path / "run.mcap";
};

TEST_F(ReadRecording, ReturnsWhatWasWritten) {
  const Recording written = test::sample_recording();
  write_recording(file_, written);
  const Recording read = read_recording(file_);
  EXPECT_TRUE(read.complete);
  EXPECT_EQ(read.title, written.title);
  EXPECT_EQ(read.scenario, written.scenario);
  EXPECT_EQ(read.seed, written.seed);
  EXPECT_EQ(read.stepper, written.stepper);
  EXPECT_EQ(read.version, written.version);
  ASSERT_EQ(read.nodes.size(), written.nodes.size());
  EXPECT_EQ(read.nodes[1].id, 16);
  EXPECT_EQ(read.nodes[1].name, written.nodes[1].name);
  expect_same(read.scene, written.scene);
  ASSERT_EQ(read.signals.size(), written.signals.size());
  EXPECT_EQ(read.signals[0].names, written.signals[0].names);
  EXPECT_EQ(read.signals[1].unit, "N");
  EXPECT_EQ(read.samples.size(), written.samples.size());
  EXPECT_EQ(read.frames.size(), written.frames.size());
  EXPECT_TRUE(is_prefix(read, written));
  ASSERT_EQ(read.events.size(), 2u);
  EXPECT_EQ(read.events[1].kind, "push");
  EXPECT_EQ(read.events[1].text, "The trunk is pushed.");
  ASSERT_EQ(read.pushes.size(), 1u);
  EXPECT_EQ(read.pushes[0].end_us, 1'300'000u);
  EXPECT_EQ(read.pushes[0].f_W_N, written.pushes[0].f_W_N);
}

TEST_F(ReadRecording, KeepsInvalidValues) {
  Recording written = test::sample_recording(1);
  written.samples[0].values.assign(3, std::nanf(""));
  write_recording(file_, written);
  const Recording read = read_recording(file_);
  for (const float value : read.samples[0].values) EXPECT_TRUE(std::isnan(value));
}

TEST_F(ReadRecording, FindsTheFileInTheFolderOfARun) {
  write_recording(file_, test::sample_recording(3));
  EXPECT_EQ(read_recording(folder_.path).samples.size(), 3u);
}

TEST_F(ReadRecording, ReadsAnInterruptedFileUpToItsLastWholeBlock) {
  const Recording whole = test::sample_recording();
  write_recording(file_, whole);
  std::size_t last = whole.samples.size();
  std::set<std::size_t> lengths;
  for (std::size_t size = std::filesystem::file_size(file_) - 1; size > 97; size -= 97) {
    std::filesystem::resize_file(file_, size);
    try {
      const Recording part = read_recording(file_);
      EXPECT_FALSE(part.complete) << size;
      EXPECT_TRUE(is_prefix(part, whole)) << size;
      EXPECT_LE(part.samples.size(), last) << size;
      last = part.samples.size();
      lengths.insert(last);
    } catch (const InputError& error) {
      EXPECT_EQ(last, 0u) << size << ": " << error.what();
    }
  }
  // The shapes alone, then each second of the run.
  EXPECT_THAT(lengths, ElementsAre(0u, 99u, 199u, 299u, 300u));
}

TEST_F(ReadRecording, AcceptsOrRejectsDamagedFilesWithOneLine) {
  const Recording whole = test::sample_recording(120);
  const std::string bytes = bytes_of(whole);
  std::mt19937 random(static_cast<unsigned>(test::kSeed));
  std::fstream file(file_, std::ios::in | std::ios::out | std::ios::binary);
  const auto put = [&file](std::size_t place, int byte) {
    file.seekp(static_cast<std::streamoff>(place)).put(static_cast<char>(byte)).flush();
  };
  int rejected = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const std::size_t place = random() % bytes.size();
    put(place, bytes[place] ^ (1 << random() % 8));
    try {
      EXPECT_TRUE(is_prefix(read_recording(file_), whole)) << place;
    } catch (const InputError& error) {
      ++rejected;
      EXPECT_THAT(error.what(), HasSubstr("run.mcap: found ")) << place;
    }
    put(place, bytes[place]);
  }
  EXPECT_GT(rejected, 200);
}

std::string error_of(const std::filesystem::path& file) {
  try {
    read_recording(file);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST_F(ReadRecording, NamesWhatIsWrong) {
  EXPECT_THAT(error_of(folder_.path), HasSubstr(": found no run.mcap, expected the folder of a run"));
  EXPECT_THAT(error_of(folder_.path / "none"), HasSubstr("found no file that can be read"));
  EXPECT_THAT(error_of(write("time_s,state\n")), HasSubstr("found other contents, expected a recording"));
  const std::string bytes = bytes_of(test::sample_recording(2));
  EXPECT_THAT(error_of(write(bytes.substr(0, 300))), HasSubstr("found an end within the first block"));
  std::string damaged = bytes;
  damaged[600] = static_cast<char>(damaged[600] + 1);
  EXPECT_THAT(error_of(write(damaged)), HasSubstr("found a block"));
}

TEST_F(ReadRecording, WritesTheSameBytesAgain) {
  EXPECT_EQ(bytes_of(test::sample_recording(150)), bytes_of(test::sample_recording(150)));
}

}  // namespace
}  // namespace koboshi::view
