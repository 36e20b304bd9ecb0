#include "view/film/film.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "base/text/error.h"
#include "tests/support/sample_recording.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::view {
namespace {

using testing::HasSubstr;

void nothing(int, int) {}

std::string error_of(const FilmOptions& options) {
  try {
    render(test::sample_recording(), options, nothing);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Width and height of a PNG file.
std::pair<unsigned, unsigned> size_of(const std::string& png) {
  const auto number = [&](std::size_t at) {
    unsigned value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = value << 8U | static_cast<unsigned char>(png.at(i));
    return value;
  };
  return {number(16), number(20)};
}

TEST(Render, RefusesWhatDoesNotFit) {
  EXPECT_THAT(error_of({.out = "film.avi"}), HasSubstr("--out: found film.avi, expected a file with the"));
  EXPECT_THAT(error_of({.out = "frame.png"}), HasSubstr("without --at and --frames"));
  EXPECT_THAT(error_of({.out = "film.mp4", .at_s = {1.0}}), HasSubstr("--at: found a film"));
  EXPECT_THAT(error_of({.out = "film.mp4", .instants = 3}), HasSubstr("--frames: found a film"));
  EXPECT_THAT(error_of({.out = "frame.png", .at_s = {3.5}}),
              HasSubstr("--at: found 3.5 s, expected a time of the recording, 0 to 3 s"));
  EXPECT_THAT(error_of({.out = "film.mp4", .from_s = 2.0, .to_s = 1.0}), HasSubstr("--to: found 1.00 s"));
  EXPECT_THAT(error_of({.out = "film.mp4", .width_px = 641, .height_px = 360}), HasSubstr("even numbers"));
  EXPECT_THAT(error_of({.out = "s.png", .width_px = 8192, .height_px = 64, .instants = 8}),
              HasSubstr("--size: found a strip of"));
}

TEST(Render, WritesThePictureOfAnInstantWithTheSameBytesEachTime) {
  const test::TemporaryFolder folder;
  FilmOptions options{.out = folder.path / "a.png", .width_px = 320, .height_px = 180, .at_s = {1.25}};
  options.overlays.add(Overlay::kTime);
  options.overlays.add(Overlay::kPushes);
  render(test::sample_recording(), options, nothing);
  options.out = folder.path / "b.png";
  render(test::sample_recording(), options, nothing);
  const std::string first = bytes_of(folder.path / "a.png");
  EXPECT_EQ(size_of(first), std::pair(320U, 180U));
  EXPECT_EQ(first, bytes_of(folder.path / "b.png"));
}

TEST(Render, WritesAStrip) {
  const test::TemporaryFolder folder;
  const FilmOptions options{
      .out = folder.path / "strip.png", .width_px = 160, .height_px = 120, .instants = 3};
  render(test::sample_recording(), options, nothing);
  EXPECT_EQ(size_of(bytes_of(options.out)), std::pair(160U * 3U + 2U * 2U, 120U));
}

TEST(Render, EncodesFilms) {
  const test::TemporaryFolder folder;
  for (const auto& [name, magic] :
       {std::pair{"f.mp4", "ftyp"}, std::pair{"f.gif", "GIF89a"}, std::pair{"f.webp", "WEBP"}}) {
    int frames = 0;
    const FilmOptions options{.out = folder.path / name,
                              .width_px = 128,
                              .height_px = 64,
                              .frames_per_s = 10.0,
                              .from_s = 1.0,
                              .to_s = 1.5};
    render(test::sample_recording(), options, [&](int done, int total) {
      frames = done;
      EXPECT_EQ(total, 5);
    });
    EXPECT_EQ(frames, 5);
    EXPECT_THAT(bytes_of(options.out).substr(0, 16), HasSubstr(magic));
  }
}

TEST(Render, LeavesNothingBehindWhenItIsInterrupted) {
  const test::TemporaryFolder folder;
  const FilmOptions options{.out = folder.path / "f.gif", .width_px = 128, .height_px = 64};
  const auto interrupt = [](int frames, int) {
    if (frames == 3) throw std::runtime_error("interrupted");
  };
  EXPECT_THROW(render(test::sample_recording(40), options, interrupt), std::runtime_error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path));
}

TEST(Render, NamesThePackageWhereThereIsNoFfmpeg) {
  const test::TemporaryFolder folder;
  const std::string path = ::getenv("PATH");
  ::setenv("PATH", folder.path.c_str(), 1);
  const std::string error = error_of({.out = folder.path / "f.mp4", .width_px = 128, .height_px = 64});
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(error,
              HasSubstr("found no program ffmpeg, which encodes films, expected it (apt install ffmpeg)"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path));
}

}  // namespace
}  // namespace koboshi::view
