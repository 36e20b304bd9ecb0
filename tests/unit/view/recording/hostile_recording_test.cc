#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include <cstdlib>
#include <cstring>
#include <exception>
#include <string>
#include <string_view>

#include "base/text/error.h"
#include "tests/support/random_frames.h"
#include "tests/support/sample_recording.h"
#include "tests/support/seed.h"
#include "tests/support/temporary_folder.h"
#include "view/recording/mcap_format.h"
#include "view/recording/read_recording.h"
#include "view/recording/recording_file.h"
#include "view/recording/recording_index.h"

namespace koboshi::view {
namespace {

using ::testing::HasSubstr;

// Number of damaged files: a second's worth, or KOBOSHI_FUZZ_FILES.
int files_to_survive() {
  const char* const wanted = std::getenv("KOBOSHI_FUZZ_FILES");
  return wanted == nullptr ? 3'000 : std::atoi(wanted);
}

template <typename Number>
Number number_at(std::string_view bytes, std::size_t place) {
  Number number;
  std::memcpy(&number, bytes.substr(place, sizeof number).data(), sizeof number);
  return number;
}

std::string record(McapRecord kind, std::string_view content) {
  std::string bytes;
  McapFields(bytes).number(static_cast<std::uint8_t>(kind)).number(std::uint64_t{content.size()});
  return bytes.append(content);
}

// The same chunk without compression and checksum.
std::string opened_chunk(std::string_view content) {
  constexpr std::size_t kTimes_bytes = 16;
  const auto size = number_at<std::uint64_t>(content, kTimes_bytes);
  const std::size_t name = kTimes_bytes + 8 + 4;
  const std::string_view stored = content.substr(name + 4 + number_at<std::uint32_t>(content, name) + 8);
  std::string records(size, '\0');
  EXPECT_EQ(ZSTD_decompress(records.data(), size, stored.data(), stored.size()), size);
  std::string opened(content.substr(0, kTimes_bytes));
  McapFields(opened).number(size).number(std::uint32_t{0}).text("").number(size);
  return opened + records;
}

// The same recording without compression and checksums, so that damage reaches what reads the messages.
std::string opened_recording(std::string_view bytes) {
  std::string opened(kMcapMagic);
  for (std::size_t place = kMcapMagic.size();;) {
    const auto kind = static_cast<McapRecord>(bytes[place]);
    const auto size = number_at<std::uint64_t>(bytes, place + 1);
    const std::string_view content = bytes.substr(place + kMcapRecordHead_bytes, size);
    place += kMcapRecordHead_bytes + size;
    if (kind == McapRecord::kDataEnd) return opened + record(kind, std::string(4, '\0')).append(kMcapMagic);
    opened += record(kind, kind == McapRecord::kChunk ? opened_chunk(content) : std::string(content));
  }
}

void damage(std::string& bytes, test::Random& random) {
  constexpr std::array<std::uint64_t, 9> kNumbers{
      0, 1, 0x7F, 0xFF, 0x7FFFFFFF, 0xFFFFFFFF, 0x3FFFFFFF, 0x7FFFFFFFFFFFFFFF, 0xFFFFFFFFFFFFFFFF};
  const std::size_t place = random.below(static_cast<std::uint32_t>(bytes.size()));
  const std::size_t length = 1 + random.below(64);
  switch (random.below(6)) {
    case 0:
      bytes[place] = static_cast<char>(bytes[place] ^ 1 << random.below(8));
      return;
    case 1:
      bytes[place] = static_cast<char>(random.next());
      return;
    case 2: {
      const std::uint64_t number = random.one_of(kNumbers);
      const std::size_t size = std::min(std::size_t{1} << random.below(4), bytes.size() - place);
      std::memcpy(bytes.data() + place, &number, size);
      return;
    }
    case 3:
      bytes.erase(place, length);
      return;
    case 4:
      bytes.insert(place, bytes.substr(random.below(static_cast<std::uint32_t>(bytes.size())), length));
      return;
    default:
      if (random.below(8) == 0) bytes.resize(place + 1);
  }
}

// Reads a recording as the studio does: each block by the index.
void read_by_index(const std::filesystem::path& file) {
  RecordingIndex index(file);
  if (index.blocks() == 0) return;
  index.block_at(index.end_us());
  for (std::size_t block = 0; block < index.blocks(); ++block) index.read(block);
}

// A stranger's file ends in a recording or in one line, whatever its bytes. The sanitizers find accesses that
// this test does not: build it with the preset asan.
TEST(HostileRecording, IsReadOrRejectedWithOneLine) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "run.mcap";
  write_recording(file, test::sample_recording(6));
  const std::string closed = test::read_file(file);
  const std::string opened = opened_recording(closed);
  test::write_file(file, opened);
  ASSERT_EQ(read_recording(file).samples.size(), 6u);
  test::Random random(test::kSeed);
  int accepted = 0;
  const int files = files_to_survive();
  ::testing::internal::CaptureStderr();
  for (int trial = 0; trial < files; ++trial) {
    std::string bytes = random.below(8) == 0 ? closed : opened;
    for (std::uint32_t i = 0; i <= random.below(3); ++i) damage(bytes, random);
    std::filesystem::remove(file);  // a file that is written anew would be put on the disk at once
    test::write_file(file, bytes);
    try {
      if (trial % 4 == 0) {
        read_by_index(file);
      } else {
        read_recording(file);
      }
      ++accepted;
    } catch (const InputError& error) {
      const std::string text = error.what();
      EXPECT_THAT(text, HasSubstr("run.mcap: found ")) << "file " << trial;
      EXPECT_EQ(text.find('\n'), std::string::npos) << "file " << trial << ": " << text;
    } catch (const std::exception& error) {
      ADD_FAILURE() << "file " << trial << ": " << error.what();
    }
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_GT(accepted, files / 20);
  EXPECT_LT(accepted, files - files / 20);
}

}  // namespace
}  // namespace koboshi::view
