#include "bus/dictionary/network.h"

#include <algorithm>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "base/text/error.h"
#include "bus/dictionary/configured_drive.h"
#include "firmware/app/dictionary.h"
#include "sim_board/drive/drive_dictionary.h"
#include "simulation/model/robot_model.h"
#include "tests/unit/bus/dictionary/default_network.h"

namespace koboshi::bus {
namespace {

TEST(Network, HasEveryNodeAndService) {
  const Network& network = default_network();
  EXPECT_EQ(network.nodes.size(), 1u + 20u + 3u + 1u);
  EXPECT_EQ(network.find(0x000)->name, "NMT");
  EXPECT_EQ(network.find(0x080)->cycle_time_ms, 10u);
  EXPECT_EQ(network.find(0x701)->cycle_time_ms, 20u);
  EXPECT_EQ(network.find(0x723)->name, "head_tilt_heartbeat");
  EXPECT_EQ(network.find(0x723)->cycle_time_ms, 100u);
  EXPECT_EQ(network.find(0x1A4)->cycle_time_ms, 4u);
  EXPECT_EQ(network.find(0x201)->cycle_time_ms, 0u);
  EXPECT_EQ(network.find(0x223)->sender, "controller");
  EXPECT_EQ(network.find(0x7FF), nullptr);
}

TEST(Network, CanBeExpressedAsADbc) {
  std::set<std::string> names;
  for (const Message& message : default_network().messages) {
    EXPECT_LE(message.name.size(), 32u) << message.name;
    EXPECT_TRUE(names.insert(message.name).second) << message.name;
    std::set<std::string> signals;
    unsigned end_bit = 0;
    for (const Signal& signal : message.signals) {
      EXPECT_LE(signal.name.size(), 32u) << signal.name;
      EXPECT_TRUE(signals.insert(signal.name).second) << message.name << " " << signal.name;
      EXPECT_GE(signal.start_bit, end_bit) << message.name << " " << signal.name;
      end_bit = signal.start_bit + signal.size_bits;
    }
    EXPECT_EQ(end_bit, 8 * message.size_bytes) << message.name;
    EXPECT_LE(message.size_bytes, 8u) << message.name;
  }
}

// The sizes of the objects that a PDO maps, which both of its ends must see alike.
std::vector<std::uint32_t> mapped_bits(const canopen::PdoConfiguration& pdo) {
  std::vector<std::uint32_t> bits;
  for (const std::uint32_t entry : pdo.mapping) {
    if (entry != 0) bits.push_back(entry & 0xFF);
  }
  return bits;
}

void expect_same(const canopen::PdoConfiguration& here, const canopen::PdoConfiguration& there) {
  EXPECT_EQ(here.cob_id & canopen::kCobIdMask, there.cob_id & canopen::kCobIdMask);
  EXPECT_EQ(mapped_bits(here), mapped_bits(there));
}

TEST(ConfiguredDrive, AgreesWithTheControllersOwnPdos) {
  const sim_board::RobotDescription robot = default_robot();
  const simulation::NamedModel model = simulation::load_named_model(robot);
  for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
    const sim_board::DriveDescription& description = robot.joints[joint].drive;
    const ConfiguredDrive drive = configure_drive(model.model.joints[joint], description);
    ASSERT_EQ(drive.rpdos.size(), 1u);
    ASSERT_EQ(drive.tpdos.size(), 1u);
    using enum canopen::PdoDirection;
    expect_same(app::drive_pdo(kTransmit, app::kFirstDriveTpdo + joint, model.model), drive.rpdos[0]);
    expect_same(app::drive_pdo(kReceive, app::kFirstDriveRpdo + joint, model.model), drive.tpdos[0]);
  }
}

// Whoever watches drives that no controller has configured reads them by the same DBC: what they send is what
// it says, and of what they take they know the beginning.
TEST(ConfiguredDrive, SendsItsDefaultPdosBeforeItsConfiguration) {
  const sim_board::RobotDescription robot = default_robot();
  const sim_board::DriveDescription& drive = robot.joints[0].drive;
  const ConfiguredDrive configured =
      configure_drive(simulation::load_named_model(robot).model.joints[0], drive);
  const canopen::NodeDescription before = sim_board::drive_node_description(drive);
  EXPECT_EQ(before.tpdos[0].cob_id + drive.node_id, configured.tpdos[0].cob_id);
  EXPECT_EQ(before.tpdos[0].mapping, configured.tpdos[0].mapping);
  EXPECT_EQ(before.rpdos[0].cob_id + drive.node_id, configured.rpdos[0].cob_id);
  EXPECT_EQ(before.rpdos[0].mapping[0], configured.rpdos[0].mapping[0]);
}

TEST(ConfiguredDrive, ListsWhatTheFirmwareWrites) {
  const sim_board::RobotDescription robot = default_robot();
  const ConfiguredDrive configured =
      configure_drive(simulation::load_named_model(robot).model.joints[0], robot.joints[0].drive);
  const auto written = [&](std::uint16_t index, std::uint8_t subindex) -> std::int64_t {
    const auto found = std::ranges::find_if(configured.writes, [&](const ConfiguredDrive::Write& write) {
      return write.address == canopen::ObjectAddress{index, subindex};
    });
    return found == configured.writes.end() ? 0 : found->value;
  };
  EXPECT_EQ(written(0x1006, 0), 10'000);
  EXPECT_EQ(written(0x1016, 1), 0x1'003C);
  EXPECT_EQ(written(0x1400, 5), 60);
  EXPECT_EQ(written(0x6060, 0), 8);
  EXPECT_LT(written(0x607D, 1), 0);
  EXPECT_GT(written(0x607D, 2), 0);
}

TEST(ConfiguredDrive, IsAnErrorForAnotherDrive) {
  const sim_board::RobotDescription robot = default_robot();
  const simulation::NamedModel model = simulation::load_named_model(robot);
  EXPECT_THROW(configure_drive(model.model.joints[0], robot.joints[1].drive), std::logic_error);
}

TEST(Network, RejectsDuplicateIdentifiers) {
  sim_board::RobotDescription robot = default_robot();
  robot.joints[0].drive.node_id = 36;
  EXPECT_THROW(make_network(robot), InputError);
}

}  // namespace
}  // namespace koboshi::bus
