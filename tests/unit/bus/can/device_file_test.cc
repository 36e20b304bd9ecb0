#include "bus/can/device_file.h"

#include <gtest/gtest.h>

#include "base/text/error.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::bus {
namespace {

using Data = std::vector<std::uint8_t>;

class DeviceFileTest : public testing::Test {
 protected:
  DeviceFile read(const std::string& text, std::uint8_t node_id = 16) {
    const std::filesystem::path file = folder_.path / "device.dcf";
    koboshi::test::write_file(file, "[DeviceInfo]\nVendorNumber=0x4B4F4249\n" + text);
    return read_device_file(file, node_id);
  }
  FileObject object(const std::string& keys) {
    return read("[2000]\nParameterName=One\n" + keys).objects.at(0);
  }
  std::string error_of(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      return std::string(error.what()).substr((folder_.path / "device.dcf").string().size());
    }
    return "";
  }

  const koboshi::test::TemporaryFolder folder_;
};

TEST_F(DeviceFileTest, ReadsNumbersInEveryNotation) {
  EXPECT_EQ(object("DataType=0x0007\nParameterValue=0x12345678\n").value, (Data{0x78, 0x56, 0x34, 0x12}));
  EXPECT_EQ(object("DataType=7\nDefaultValue=$NODEID+0x180\n").value, (Data{0x90, 0x01, 0, 0}));
  EXPECT_EQ(object("DataType=7\nDefaultValue=0x600 + $NodeID\n").value, (Data{0x10, 0x06, 0, 0}));
  EXPECT_EQ(object("DataType=0x0003\nDefaultValue=-2\n").value, (Data{0xFE, 0xFF}));
  EXPECT_EQ(object("DataType=5\nDefaultValue=010\n").value, Data{8});  // octal
  EXPECT_EQ(object("DataType=1\nDefaultValue=1\n").value, Data{1});
  EXPECT_EQ(object("DataType=0x1B\nDefaultValue=0x0102030405060708\n").value, (Data{8, 7, 6, 5, 4, 3, 2, 1}));
  EXPECT_EQ(object("DataType=8\nDefaultValue=1.5\n").value, (Data{0, 0, 0xC0, 0x3F}));
  EXPECT_EQ(object("DataType=9\nDefaultValue=drive\n").value, (Data{'d', 'r', 'i', 'v', 'e'}));
  EXPECT_EQ(object("DataType=0xA\nDefaultValue=01 FF\n").value, (Data{1, 0xFF}));
  EXPECT_EQ(object("DataType=7\nDefaultValue=\n").value, std::nullopt);
}

TEST_F(DeviceFileTest, PrefersTheParameterValueAndKnowsTheAccess) {
  const FileObject one = object("DataType=5\nAccessType=rww\nDefaultValue=1\nParameterValue=2\n");
  EXPECT_EQ(one.value, Data{2});
  EXPECT_TRUE(one.is_parameter && one.readable && one.writable);
  EXPECT_FALSE(object("DataType=5\nAccessType=const\n").writable);
  EXPECT_FALSE(object("DataType=5\nAccessType=wo\n").readable);
  EXPECT_FALSE(object("DataType=5\nAccessType=rw\nObjFlags=0x1\n").writable);
  EXPECT_TRUE(object("DataType=0xF\nAccessType=rw\n").is_domain);
}

TEST_F(DeviceFileTest, ReadsRecordsAndCompactArrays) {
  const DeviceFile file = read(
      "; "
      "comment\n[1018]\nObjectType=9\nSubNumber=2\n[1018sub0]\nDataType=5\nDefaultValue=1\n[1018subA]"
      "\nDataType=7\n"
      "[2402]\nParameterName=CRC\nObjectType=8\nDataType=7\nAccessType=rw\nCompactSubObj=3\nDefaultValue=9\n"
      "[2402Value]\nNrOfEntries=1\n2=5\n[DeviceComissioning]\nNodeID=3\n");
  ASSERT_EQ(file.objects.size(), 5u);
  EXPECT_EQ(file.objects[1].address, (canopen::ObjectAddress{0x1018, 10}));
  EXPECT_EQ(file.objects[3].address, (canopen::ObjectAddress{0x2402, 2}));
  EXPECT_EQ(file.objects[3].value, (Data{5, 0, 0, 0}));
  EXPECT_EQ(file.objects[4].value, (Data{9, 0, 0, 0}));
  EXPECT_TRUE(file.is_dcf);
  EXPECT_EQ(file.node_id, 3);
  EXPECT_EQ(file.vendor_id, 0x4B4F'4249u);
}

TEST_F(DeviceFileTest, RefusesBadFilesWithTheLine) {
  EXPECT_EQ(error_of("[2000]\nDataType=5\nDefaultValue=256\n"), ":5: found 256, expected a number of 8 bits");
  EXPECT_EQ(error_of("[2000]\nDataType=5\nAccessType=never\n"),
            ":5: found never, expected ro, wo, rw, rwr, rww or const");
  EXPECT_EQ(error_of("nonsense\n"), ":3: found nonsense, expected KEY=VALUE or [SECTION]");
  EXPECT_THROW(read_device_file(folder_.path / "none.dcf", 1), InputError);
  koboshi::test::write_file(folder_.path / "x.ini", "[Other]\na=1\n");
  EXPECT_THROW(read_device_file(folder_.path / "x.ini", 1), InputError);
}

}  // namespace
}  // namespace koboshi::bus
