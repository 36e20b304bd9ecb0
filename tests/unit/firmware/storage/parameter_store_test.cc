#include "firmware/storage/parameter_store.h"

#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <vector>

#include "tests/unit/firmware/storage/cut_flash.h"

namespace koboshi::storage {
namespace {

TEST(IndexRange, ContainsBothItsEnds) {
  constexpr IndexRange kProfile{0x6000, 0x9FFF};
  EXPECT_TRUE(kProfile.contains(0x6000));
  EXPECT_TRUE(kProfile.contains(0x9FFF));
  EXPECT_FALSE(kProfile.contains(0x5FFF));
  EXPECT_FALSE(kProfile.contains(0xA000));
}

TEST(IndexRange, ContainsAllIndicesAtFirst) {
  EXPECT_TRUE(IndexRange().contains(0));
  EXPECT_TRUE(IndexRange().contains(0xFFFF));
}

constexpr IndexRange kLow{0x1000, 0x1FFF};
constexpr IndexRange kHigh{0x6000, 0x9FFF};

// A device with these values. It remembers what was restored.
struct Device final : ParameterOwner {
  bool next_parameter(std::size_t& place, ParameterRecord& record) const override {
    if (place >= values.size()) return false;
    record = values[place++];
    return true;
  }
  void restore(const ParameterRecord& record) override { restored.push_back(record); }

  std::vector<ParameterRecord> values;
  std::vector<ParameterRecord> restored;
};

class ParameterStoreTest : public testing::Test {
 protected:
  static constexpr std::size_t kLogSize = 4 * 1024;

  ParameterStoreTest() { device.values = {first, second, third}; }

  // Repeats the call until it is no longer busy, a millisecond later each time.
  template <typename Verb>
  Status end_of(const Verb& verb) {
    for (int i = 0; i < 200; ++i) {
      const Status status = verb();
      if (status != Status::kBusy) return status;
      tick();
    }
    ADD_FAILURE() << "the store stays busy";
    return Status::kBusy;
  }
  Status store(IndexRange range, bool may_write = true) {
    return end_of([&] { return parameters.store(range, may_write); });
  }
  Status clear(IndexRange range, bool may_write = true) {
    return end_of([&] { return parameters.clear(range, may_write); });
  }
  void tick() {
    parameters.process();
    items.process();
  }
  // The records in flash.
  std::vector<ParameterRecord> stored() const {
    const auto item = items.find(ItemKind::kParameters, 0);
    std::vector<ParameterRecord> records;
    ParameterRecord record;
    while (read_record(item, ParameterRecord::kSize_bytes * records.size(), record))
      records.push_back(record);
    EXPECT_EQ(item.size(), ParameterRecord::kSize_bytes * records.size());
    return records;
  }
  std::vector<ParameterRecord> loaded(IndexRange range = {}) {
    device.restored.clear();
    parameters.load(range);
    return device.restored;
  }

  using Records = std::vector<ParameterRecord>;
  ParameterRecord first{.index = 0x1017, .subindex = 0, .size_bytes = 2, .value = 500};
  ParameterRecord second{.index = 0x6000, .subindex = 3, .size_bytes = 1, .value = 7};
  ParameterRecord third{.index = 0x9FFF, .subindex = 0xFE, .size_bytes = 4, .value = 0x8765'4321};
  Device device;
  test::CutFlash flash{kLogSize, 512};
  ItemStore items{flash, kLogSize};
  ParameterStore parameters{items, device};
};

// The format is that of the header's comment, byte by byte.
TEST_F(ParameterStoreTest, WritesItsRecordsInTheFormatOfThePage) {
  device.values = {third};
  ASSERT_EQ(store({}), Status::kOk);
  const auto item = items.find(ItemKind::kParameters, 0);
  constexpr std::array<std::uint8_t, 8> kExpected{0xFF, 0x9F, 0xFE, 4, 0x21, 0x43, 0x65, 0x87};
  ASSERT_EQ(item.size(), kExpected.size());
  for (std::size_t i = 0; i < item.size(); ++i) EXPECT_EQ(std::to_integer<int>(item[i]), kExpected[i]) << i;
}

TEST_F(ParameterStoreTest, ReadsWholeRecordsOnly) {
  const std::array<std::byte, 17> item{};
  ParameterRecord record;
  EXPECT_TRUE(read_record(item, 0, record));
  EXPECT_TRUE(read_record(item, 9, record));
  EXPECT_FALSE(read_record(item, 10, record));
  EXPECT_FALSE(read_record(item, 17, record));
}

TEST_F(ParameterStoreTest, GivesTheOwnerWhatWasStoredInItsRange) {
  ASSERT_EQ(store({}), Status::kOk);
  EXPECT_EQ(loaded(), (Records{first, second, third}));
  EXPECT_EQ(loaded(kLow), (Records{first}));
  EXPECT_EQ(loaded(kHigh), (Records{second, third}));
  EXPECT_EQ(loaded({0x2000, 0x5FFF}), Records());
}

// The others stay as they are stored, although the device has other values of them now.
TEST_F(ParameterStoreTest, ChangesTheValuesOfItsRangeOnly) {
  ASSERT_EQ(store({}), Status::kOk);
  const Records old = device.values;
  for (ParameterRecord& record : device.values) record.value += 1;
  ASSERT_EQ(store(kHigh), Status::kOk);
  EXPECT_EQ(stored(), (Records{old[0], device.values[1], device.values[2]}));
  ASSERT_EQ(store(kLow), Status::kOk);
  EXPECT_EQ(stored(), (Records{device.values[1], device.values[2], device.values[0]}));
}

TEST_F(ParameterStoreTest, ClearsTheValuesOfItsRangeOnly) {
  ASSERT_EQ(store({}), Status::kOk);
  ASSERT_EQ(clear(kHigh), Status::kOk);
  EXPECT_EQ(stored(), (Records{first}));
  ASSERT_EQ(clear(kLow), Status::kOk);
  EXPECT_EQ(stored(), Records());
  ASSERT_EQ(store(kHigh), Status::kOk);
  EXPECT_EQ(stored(), (Records{second, third}));
}

TEST_F(ParameterStoreTest, WritesNothingThatIsStored) {
  ASSERT_EQ(clear({}), Status::kOk) << "nothing is stored";
  EXPECT_EQ(flash.words, 0u);
  ASSERT_EQ(store({}), Status::kOk);
  for (int i = 0; i < 50; ++i) tick();
  const auto words = flash.words;
  EXPECT_GT(words, 0u);
  EXPECT_EQ(parameters.store({}), Status::kOk) << "at once";
  EXPECT_EQ(parameters.store(kHigh), Status::kOk);
  EXPECT_EQ(parameters.clear({0x2000, 0x2FFF}), Status::kOk);
  EXPECT_EQ(parameters.store({}, false), Status::kOk) << "there is nothing to write";
  for (int i = 0; i < 50; ++i) tick();
  EXPECT_EQ(flash.words, words);
  device.values.pop_back();
  ASSERT_EQ(store({}), Status::kOk) << "one value fewer is another item";
  EXPECT_EQ(stored(), (Records{first, second}));
}

// Each field of a record counts.
TEST_F(ParameterStoreTest, WritesWhateverFieldHasChanged) {
  for (int field = 0; field < 4; ++field) {
    ParameterRecord& last = device.values.back();
    if (field == 0) last.index -= 1;
    if (field == 1) last.subindex -= 1;
    if (field == 2) last.size_bytes -= 1;
    if (field == 3) last.value += 1u << 31;
    ASSERT_EQ(parameters.store({}, false), Status::kNotAllowed) << field;
    ASSERT_EQ(store({}), Status::kOk) << field;
    EXPECT_EQ(stored(), device.values) << field;
  }
}

TEST_F(ParameterStoreTest, WritesNothingWhereItMayNot) {
  EXPECT_EQ(parameters.store({}, false), Status::kNotAllowed);
  for (int i = 0; i < 50; ++i) tick();
  EXPECT_EQ(stored(), Records());
  ASSERT_EQ(store({}), Status::kOk);
  EXPECT_EQ(parameters.clear(kLow, false), Status::kNotAllowed);
}

TEST_F(ParameterStoreTest, IsBusyForOtherRangesMeanwhile) {
  EXPECT_EQ(parameters.store(kHigh), Status::kBusy);
  EXPECT_EQ(parameters.store(kLow), Status::kBusy);
  EXPECT_EQ(parameters.clear(kLow, false), Status::kBusy);
  ASSERT_EQ(store(kHigh), Status::kOk);
  EXPECT_EQ(stored(), (Records{second, third})) << "the other call has changed nothing";
}

TEST_F(ParameterStoreTest, LeavesTheLogToOthersWhenItHasEnded) {
  EXPECT_EQ(parameters.store(kHigh), Status::kBusy);
  for (int i = 0; i < 2; ++i) tick();  // the erasure of a sector, and the item begins
  EXPECT_EQ(items.begin(ItemKind::kMotion, 1, 8), Status::kInUse);
  ASSERT_EQ(store(kHigh), Status::kOk);
  EXPECT_EQ(end_of([&] { return items.begin(ItemKind::kMotion, 1, 8); }), Status::kOk);
  // Another item is being written: the reason comes to the caller.
  EXPECT_EQ(store(kLow), Status::kInUse);
  items.release();
  EXPECT_EQ(store(kLow), Status::kOk);
}

TEST_F(ParameterStoreTest, ReportsAFailureOnceToTheCallerOfItsRange) {
  flash.fail_next();
  ASSERT_EQ(parameters.store(kHigh), Status::kBusy);
  for (int i = 0; i < 200; ++i) tick();
  EXPECT_EQ(stored(), Records());
  EXPECT_EQ(parameters.store(kHigh), Status::kFailed);
  ASSERT_EQ(parameters.store(kHigh), Status::kBusy) << "it begins again";
  EXPECT_EQ(store(kHigh), Status::kOk);
  EXPECT_EQ(stored(), (Records{second, third}));
}

// A change of another range begins in spite of it, and leaves it to its caller.
TEST_F(ParameterStoreTest, KeepsAFailureForItsRange) {
  flash.fail_next();
  ASSERT_EQ(parameters.store(kHigh), Status::kBusy);
  for (int i = 0; i < 200; ++i) tick();
  EXPECT_EQ(store(kLow), Status::kOk);
  EXPECT_EQ(stored(), (Records{first}));
  EXPECT_EQ(parameters.store(kHigh), Status::kFailed);
}

TEST_F(ParameterStoreTest, AbandonsAChangeAndItsFailureByLoading) {
  ASSERT_EQ(store(kLow), Status::kOk);
  ASSERT_EQ(parameters.store(kHigh), Status::kBusy);
  tick();
  EXPECT_EQ(loaded(), (Records{first}));
  for (int i = 0; i < 200; ++i) tick();
  EXPECT_EQ(stored(), (Records{first}));
  EXPECT_EQ(end_of([&] { return items.begin(ItemKind::kMotion, 1, 8); }), Status::kOk) << "nobody writes";
  items.release();
  flash.fail_next();
  ASSERT_EQ(parameters.store(kHigh), Status::kBusy);
  for (int i = 0; i < 200; ++i) tick();
  parameters.load({});
  EXPECT_EQ(store(kHigh), Status::kOk) << "the failure is forgotten";
}

// More records than the log takes in one call: the flash is slower.
TEST_F(ParameterStoreTest, WritesMoreRecordsThanAPageHolds) {
  device.values.clear();
  for (std::uint16_t i = 0; i < 120; ++i)
    device.values.push_back(
        {.index = static_cast<std::uint16_t>(0x6000 + i), .subindex = 1, .size_bytes = 4, .value = i * 77u});
  ASSERT_EQ(store({}), Status::kOk);
  EXPECT_EQ(stored(), device.values);
  EXPECT_EQ(loaded(), device.values);
}

}  // namespace
}  // namespace koboshi::storage
