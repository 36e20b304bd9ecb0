#include "firmware/app/factory_parameters.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

#include "firmware/storage/image.h"
#include "tests/support/factory_values.h"
#include "tests/support/robot_storage.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::app {
namespace {

constexpr std::uint32_t kFoundFor = 0xC0FFEE;

struct FewValues {
  std::uint8_t share = 7;
  std::int16_t gain = 0;
  std::uint32_t serial = 1;
  std::uint16_t shown = 3;
  std::int16_t request = 0;
};

using canopen::Access;
using canopen::Mappable;

constexpr std::array kFewRows{
    canopen::object(0x1F80, 0, KOBOSHI_FIELD(FewValues, serial), Access::kReadWrite),
    canopen::object(0x2000, 1, KOBOSHI_FIELD(FewValues, request), Access::kReadWrite, Mappable::kRpdo),
    canopen::object(0x2100, 1, KOBOSHI_FIELD(FewValues, share), Access::kReadWrite).within(1, 100),
    canopen::object(0x2100, 2, KOBOSHI_FIELD(FewValues, gain), Access::kReadWrite).within(-4096, 4096),
    canopen::object(0x2200, 1, KOBOSHI_FIELD(FewValues, shown), Access::kReadOnly),
};

struct FewRecord {
  std::uint16_t index;
  std::uint8_t subindex;
  std::uint8_t size;
  std::int32_t value;
};

std::vector<std::byte> item_of(const std::vector<FewRecord>& records, std::uint32_t model_id = kFoundFor) {
  std::vector<std::byte> image;
  test::put(image, kFactoryParametersMagic, 4);
  test::put(image, kFactoryParametersVersion, 4);
  image.resize(storage::kImageHeaderSize);
  test::put(image, model_id, 4);
  for (const FewRecord& record : records) {
    test::put(image, record.index, 2);
    test::put(image, record.subindex, 1);
    test::put(image, record.size, 1);
    test::put(image, static_cast<std::uint32_t>(record.value), 4);
  }
  test::seal(image);
  return image;
}

class LoadFactoryParameters : public testing::Test {
 protected:
  FactoryStatus load(std::span<const std::byte> item) {
    return load_factory_parameters(item, kFoundFor,
                                   {kFewRows, std::as_writable_bytes(std::span(&values_, 1))});
  }
  void expect_neutral() const {
    EXPECT_EQ(values_.share, 7);
    EXPECT_EQ(values_.gain, 0);
    EXPECT_EQ(values_.serial, 1u);
    EXPECT_EQ(values_.shown, 3);
    EXPECT_EQ(values_.request, 0);
  }

  FewValues values_;
};

const std::vector<FewRecord> kGood{{0x2100, 1, 1, 40}, {0x2100, 2, 2, -300}};

TEST_F(LoadFactoryParameters, AreWrittenIntoTheDictionary) {
  EXPECT_EQ(load(item_of(kGood)), FactoryStatus::kLoaded);
  EXPECT_EQ(values_.share, 40);
  EXPECT_EQ(values_.gain, -300);
}

TEST_F(LoadFactoryParameters, MayBeEmpty) {
  EXPECT_EQ(load({}), FactoryStatus::kNone);
  expect_neutral();
  EXPECT_EQ(load(item_of({})), FactoryStatus::kLoaded);  // an item without records
  expect_neutral();
}

TEST_F(LoadFactoryParameters, BelongToOneModel) {
  EXPECT_EQ(load(item_of(kGood, kFoundFor + 1)), FactoryStatus::kOtherModel);
  expect_neutral();
}

TEST_F(LoadFactoryParameters, AreNotLoadedWhenChangedOrTruncated) {
  const auto good = item_of(kGood);
  for (std::size_t at = 0; at < good.size(); ++at) {
    auto damaged = good;
    damaged[at] ^= std::byte{0x10};
    EXPECT_NE(load(damaged), FactoryStatus::kLoaded) << at;
    EXPECT_NE(load(std::span(good).first(at)), FactoryStatus::kLoaded) << at;
  }
  expect_neutral();
}

TEST_F(LoadFactoryParameters, EndWithACompleteRecord) {
  auto half = item_of(kGood);
  half.resize(half.size() - 3);
  test::seal(half);
  EXPECT_EQ(load(half), FactoryStatus::kDamaged);
  auto without_model = item_of({});
  without_model.resize(without_model.size() - 1);
  test::seal(without_model);
  EXPECT_EQ(load(without_model), FactoryStatus::kDamaged);
  expect_neutral();
}

TEST_F(LoadFactoryParameters, AreRejectedAsAWholeForOneInvalidValue) {
  for (const FewRecord& bad : std::to_array<FewRecord>({{0x2100, 1, 1, 101},    // too high
                                                        {0x2100, 1, 1, 0},      // too low
                                                        {0x2100, 2, 2, -4097},  // too low for a signed
                                                                                // parameter
                                                        {0x2100, 2, 4, 5},      // wrong size
                                                        {0x2100, 2, 0, 5},      // no size
                                                        {0x2100, 3, 1, 5},      // no such sub-index
                                                        {0x2101, 1, 1, 5},      // no such object
                                                        {0x2200, 1, 2, 5},      // read-only
                                                        {0x2000, 1, 2, 5},      // a process value
                                                        {0x1F80, 0, 4, 5}})) {  // a communication object
    auto records = kGood;
    records.push_back(bad);
    EXPECT_EQ(load(item_of(records)), FactoryStatus::kRefused) << bad.index << ' ' << bad.value;
    expect_neutral();
  }
}

}  // namespace
}  // namespace koboshi::app
