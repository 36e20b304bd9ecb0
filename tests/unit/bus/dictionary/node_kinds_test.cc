#include "bus/dictionary/node_kinds.h"

#include <initializer_list>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "firmware/app/dictionary.h"
#include "firmware/canopen/node/device_services.h"
#include "sim_board/drive/drive_dictionary.h"
#include "sim_board/sensor/sensor_dictionary.h"
#include "simulation/model/robot_model.h"
#include "tests/unit/bus/dictionary/default_network.h"

namespace koboshi::bus {
namespace {

using canopen::AbortCode;

constexpr std::uint8_t kNodeId = 5;

class NoSink final : public canopen::FrameSink {
 public:
  bool send(const hal::CanFrame&) override { return true; }
};

// A node of the kind as it is on the bus, with the application's part left out.
template <typename Values, typename Memory>
class RealNode final : private canopen::NodeApplication, private canopen::DeviceOwner {
 public:
  // The controller's, with its drives.
  explicit RealNode(const NodeKind& kind, const robot::RobotModel& robot = {}, std::uint8_t node_id = kNodeId)
      : robot_(robot),
        services_({1, 2, 3, 7}, *this),
        node(kind.description,
             {.node_id = node_id,
              .serial_number = 7,
              .values = std::as_writable_bytes(std::span(&values_, 1)),
              .services = kind.description.field_device ? &services_ : nullptr},
             memory_.buffers(), sink_, *this) {
    services_.start(node_id);
    node.start(0);
  }

 private:
  canopen::PdoConfiguration default_pdo(canopen::PdoDirection direction, std::size_t number) override {
    return app::drive_pdo(direction, number, robot_);
  }
  std::uint32_t default_consumer(std::size_t number) override { return app::drive_consumer(number, robot_); }

  const robot::RobotModel robot_;
  Values values_;
  Memory memory_;
  NoSink sink_;
  canopen::DeviceServices services_;

 public:
  canopen::Node node;
};

std::int64_t number_of(const std::string& text, std::uint8_t node_id) {
  const std::string prefix = "$NODEID+";
  if (text.starts_with(prefix)) return node_id + std::stoll(text.substr(prefix.size()), nullptr, 0);
  return std::stoll(text, nullptr, 0);
}

void expect_default(const ObjectItem& item, const canopen::ObjectValue& value,
                    std::uint8_t node_id = kNodeId) {
  if (item.default_value.empty()) return;
  if (item.data_type == kVisibleString) {
    const auto bytes = value.bytes();
    EXPECT_EQ(std::string(bytes.begin(), bytes.end()), item.default_value);
    return;
  }
  const std::uint64_t mask = (std::uint64_t{1} << size_bits(item.data_type)) - 1;
  EXPECT_EQ(value.number(), static_cast<std::uint64_t>(number_of(item.default_value, node_id)) & mask);
}

void expect_item(canopen::Node& node, const ObjectItem& item) {
  if (item.data_type == static_cast<std::uint8_t>(canopen::DataType::kDomain)) {
    // The node knows it, but nobody has its bytes here.
    canopen::Domain* domain = nullptr;
    EXPECT_EQ(node.open_domain(item.address, canopen::Access::kReadOnly, domain),
              AbortCode::kResourceNotAvailable);
    return;
  }
  canopen::ObjectValue value;
  const AbortCode read = node.read_object(item.address, value);
  if (read == AbortCode::kNoData) return;  // an error history that is empty yet
  ASSERT_EQ(read, AbortCode::kNone);
  if (item.data_type != kVisibleString) {
    EXPECT_EQ(8u * value.size(), size_bits(item.data_type));
  }
  expect_default(item, value);
  const bool read_only = item.access == "ro" || item.access == "const";
  EXPECT_EQ(node.write_object(item.address, value.number(), 0) == AbortCode::kWriteOfReadOnly, read_only);
}

void expect_all_described(canopen::Node& node, const NodeKind& kind) {
  for (unsigned index = 0x1000; index < 0xA000; ++index) {
    for (unsigned subindex = 0; subindex < 255; ++subindex) {
      const canopen::ObjectAddress address{static_cast<std::uint16_t>(index),
                                           static_cast<std::uint8_t>(subindex)};
      canopen::ObjectValue value;
      const AbortCode read = node.read_object(address, value);
      if (read == AbortCode::kObjectDoesNotExist) break;
      if (read != AbortCode::kNone) continue;
      EXPECT_NE(kind.find(address), nullptr) << std::hex << index << " sub " << subindex;
    }
  }
}

template <typename Values, typename Memory>
void expect_true(const NodeKind& kind, const robot::RobotModel& robot = {}) {
  RealNode<Values, Memory> real(kind, robot);
  expect_all_described(real.node, kind);
  for (const Object& object : kind.objects) {
    for (const ObjectItem& item : object.items) {
      SCOPED_TRACE(testing::Message() << kind.name << " " << std::hex << item.address.index << " sub "
                                      << int{item.address.subindex} << ": " << item.name);
      expect_item(real.node, item);
    }
  }
}

TEST(Controller, HasTheObjectsOfItsDataSheetAndNoOthers) {
  const robot::RobotModel model = simulation::load_named_model(default_robot()).model;
  expect_true<
      app::ControllerValues,
      canopen::NodeMemory<app::kRpdos, app::kTelemetryTpdos + robot::kMaxJoints, robot::kMaxJoints, 32>>(
      controller_kind(model), model);
}

TEST(Controller, HasThePdosAndConsumersOfItsDrives) {
  const robot::RobotModel model = simulation::load_named_model(default_robot()).model;
  const NodeKind kind = controller_kind(model);
  EXPECT_EQ(kind.find({0x1400 + 2, 1})->default_value, "$NODEID+0x400");  // motion inputs
  EXPECT_EQ(kind.find({0x1400 + 3, 1})->default_value, "0x00000190");
  EXPECT_EQ(kind.find({0x1800 + 10, 1})->default_value, "0x40000210");  // behind the telemetry
  EXPECT_EQ(kind.find({0x1A00 + 29, 0})->default_value, "2");
  EXPECT_EQ(kind.find({0x1800 + 30, 1})->default_value, "0xC0000000");
  EXPECT_EQ(kind.find({0x1016, 20})->default_value, "0x0023015E");
  EXPECT_EQ(kind.find({0x1016, 21})->default_value, "0x00000000");
}

TEST(Drive, HasTheObjectsOfItsDataSheetAndNoOthers) {
  expect_true<sim_board::DriveValues, canopen::NodeMemory<4, 4, 2, 8>>(drive_kind());
}

// One data sheet serves the drives of all node ids: those of both ranges with a second SDO channel, and
// others.
TEST(Drive, HasTheDefaultsOfItsDataSheetWithAnyNodeId) {
  const NodeKind sheet = drive_kind();
  for (const std::uint8_t node_id : std::initializer_list<std::uint8_t>{1, 15, 16, 35, 36, 39, 58, 59, 127}) {
    NodeKind own = sheet;
    own.description = sim_board::drive_node_description({.node_id = node_id});
    RealNode<sim_board::DriveValues, canopen::NodeMemory<4, 4, 2, 8>> real(own, {}, node_id);
    for (const Object& object : sheet.objects) {
      for (const ObjectItem& item : object.items) {
        canopen::ObjectValue value;
        if (real.node.read_object(item.address, value) != AbortCode::kNone) continue;
        if (object.index == 0x1018) continue;  // the maker's, of the description
        SCOPED_TRACE(testing::Message() << "node " << int{node_id} << ", " << std::hex << object.index
                                        << " sub " << int{item.address.subindex} << ": " << item.name);
        expect_default(item, value, node_id);
      }
    }
  }
}

TEST(Sensor, HasTheObjectsOfItsDataSheetAndNoOthers) {
  expect_true<sim_board::SensorValues, canopen::NodeMemory<0, 2, 2, 8>>(inertial_kind());
  expect_true<sim_board::SensorValues, canopen::NodeMemory<0, 2, 2, 8>>(ankle_kind());
}

TEST(Sensor, HasNoObjectsOfTheOtherKind) {
  EXPECT_EQ(inertial_kind().find({0x2020, 1}), nullptr);
  EXPECT_EQ(ankle_kind().find({0x2010, 1}), nullptr);
  EXPECT_EQ(ankle_kind().find({0x1018, 2})->default_value, "0x00004B03");
}

TEST(NodeKind, HasNoDefaultsForProcessValues) {
  for (const NodeKind& kind : documented_kinds({})) {
    for (const Object& object : kind.objects) {
      for (const ObjectItem& item : object.items) {
        if (item.mappable == canopen::Mappable::kNo) continue;
        EXPECT_TRUE(item.default_value.empty()) << kind.name << " " << item.name;
      }
    }
  }
}

TEST(NodeKind, NamesItsObjects) {
  const NodeKind kind = controller_kind();
  EXPECT_EQ(kind.find({0x2010, 4})->name, "Rate y");
  EXPECT_EQ(kind.find({0x2300, 31})->name, "Controlword of joint 31");
  EXPECT_EQ(kind.find({0x2300, 32}), nullptr);
  EXPECT_EQ(kind.find({0x2FFF, 0}), nullptr);
  EXPECT_EQ(kind.find({0x2300, 0})->default_value, "31");
}

TEST(NodeKind, IsAnArrayIfAllSubindicesShareOneRow) {
  const std::map<std::uint16_t, ObjectType> expected{
      {0x607D, ObjectType::kArray}, {0x60C2, ObjectType::kRecord}, {0x6040, ObjectType::kVariable}};
  for (const Object& object : drive_kind().objects) {
    const auto known = expected.find(object.index);
    if (known != expected.end()) {
      EXPECT_EQ(object.type, known->second) << std::hex << object.index;
    }
  }
}

}  // namespace
}  // namespace koboshi::bus
