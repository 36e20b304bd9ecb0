#include "firmware/storage/image.h"

#include <gtest/gtest.h>

#include <string_view>

#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::storage {
namespace {

constexpr std::uint32_t kMagic = 0x12345678;

std::vector<std::byte> make_image(std::size_t body_size) {
  std::vector<std::byte> image;
  test::put(image, kMagic, 4);
  test::put(image, 3, 4);  // version and the reserved field
  image.resize(kImageHeaderSize + body_size, std::byte{0xA5});
  test::seal(image);
  return image;
}

TEST(Crc32, GivesTheStandardsCheckValue) {
  const std::string_view digits = "123456789";
  const auto bytes = std::as_bytes(std::span(digits));
  EXPECT_EQ(crc32(bytes), 0xCBF43926u);
  EXPECT_EQ(crc32(bytes.subspan(4), crc32(bytes.first(4))), 0xCBF43926u);
  EXPECT_EQ(crc32({}), 0u);
}

TEST(ImageReader, ReadsLittleEndianWithinBounds) {
  const std::array<std::byte, 8> bytes{std::byte{1},    std::byte{0xFE}, std::byte{0x34}, std::byte{0x12},
                                       std::byte{0xFF}, std::byte{0xFF}, std::byte{0xFF}, std::byte{9}};
  ImageReader reader(bytes);
  EXPECT_EQ(reader.u8(), 1);
  EXPECT_EQ(reader.i8(), -2);
  EXPECT_EQ(reader.u16(), 0x1234);
  EXPECT_EQ(reader.remaining(), 4u);
  EXPECT_TRUE(reader.ok());
  EXPECT_EQ(reader.i32(), 0x09FFFFFF);
  EXPECT_EQ(reader.u8(), 0);
  EXPECT_FALSE(reader.ok());
}

TEST(OpenImage, FindsTheBodyInALongerSector) {
  std::vector<std::byte> sector = make_image(5);
  sector.resize(4096, std::byte{0xFF});
  Image image;
  ASSERT_EQ(open_image(sector, kMagic, 3, image), ImageStatus::kOk);
  EXPECT_EQ(image.body.size(), 5u);
  EXPECT_EQ(image.body.data(), sector.data() + kImageHeaderSize);
}

TEST(OpenImage, RefusesWithTheReason) {
  const std::vector<std::byte> good = make_image(5);
  Image image;
  EXPECT_EQ(open_image(good, kMagic + 1, 3, image), ImageStatus::kBadMagic);
  EXPECT_EQ(open_image(good, kMagic, 4, image), ImageStatus::kBadVersion);
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_EQ(open_image(std::span(good).first(size), kMagic, 3, image), ImageStatus::kTruncated) << size;
  }
  std::vector<std::byte> reserved = good;
  reserved[6] = std::byte{1};
  EXPECT_EQ(open_image(reserved, kMagic, 3, image), ImageStatus::kBadSize);
  EXPECT_TRUE(image.body.empty());
}

TEST(OpenImage, DetectsEachFlippedBit) {
  const std::vector<std::byte> good = make_image(5);
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    std::vector<std::byte> bad = good;
    bad[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    Image image;
    EXPECT_NE(open_image(bad, kMagic, 3, image), ImageStatus::kOk) << "bit " << bit;
  }
}

}  // namespace
}  // namespace koboshi::storage
