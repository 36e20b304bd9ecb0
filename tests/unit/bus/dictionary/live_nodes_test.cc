// The defaults of the data sheets are the values of the robot's nodes after power-on: a tool that writes all
// of them changes nothing.

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bus/dictionary/node_kinds.h"
#include "sim_board/sensor/sensor_node.h"
#include "simulation/assembly/board_without_controller.h"
#include "simulation/assembly/parameters.h"
#include "simulation/assembly/simulation.h"
#include "simulation/scenario/operator_pc.h"
#include "simulation/scenario/reader.h"
#include "tests/unit/bus/dictionary/default_network.h"

namespace koboshi::bus {
namespace {

const std::filesystem::path kSource = KOBOSHI_SOURCE_DIR;

simulation::Scenario scenario(const std::string& name) {
  return simulation::read_scenario(kSource / "scenarios" / name);
}

// The value of a default in the notation of an EDS, for a node; a text as it is.
std::vector<std::uint8_t> bytes_of(const ObjectItem& item, std::uint8_t node_id) {
  std::string text = item.default_value;
  if (item.data_type == kVisibleString) return {text.begin(), text.end()};
  const std::string prefix = "$NODEID+";
  const bool relative = text.starts_with(prefix);
  if (relative) text = text.substr(prefix.size());
  auto value = static_cast<std::uint64_t>(std::stoll(text, nullptr, 0) + (relative ? node_id : 0));
  std::vector<std::uint8_t> bytes(size_bits(item.data_type) / 8);
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(value);
    value >>= 8;
  }
  return bytes;
}

// Reads every object with a default from a node, and compares.
class LiveNodes {
 public:
  using Request = std::function<void(simulation::ObjectRequest)>;
  using Answers = std::function<std::vector<simulation::ObjectAnswer>()>;

  void expect(const NodeKind& kind, std::uint8_t node_id) {
    for (const Object& object : kind.objects) {
      for (const ObjectItem& item : object.items) {
        if (!item.default_value.empty()) wanted_.push_back({&item, node_id});
      }
    }
  }
  // `advance` passes a millisecond and returns the answers in it.
  void compare(const Request& request, const Answers& advance) {
    for (std::uint64_t number = 0; number < wanted_.size(); ++number)
      request(
          {.number = number, .node_id = wanted_[number].node_id, .address = wanted_[number].item->address});
    std::size_t answers = 0;
    for (int ms = 0; answers < wanted_.size() && ms < 200'000; ++ms) {
      for (const simulation::ObjectAnswer& answer : advance()) {
        ++answers;
        const auto& [item, node_id] = wanted_[answer.number];
        EXPECT_EQ(answer.abort, canopen::AbortCode::kNone);
        EXPECT_EQ(answer.data, bytes_of(*item, node_id))
            << "node " << int{node_id} << ", object " << std::hex << item->address.index << " sub "
            << int{item->address.subindex} << ", " << item->name << ", default " << item->default_value;
      }
    }
    EXPECT_EQ(answers, wanted_.size());
  }

 private:
  struct Wanted {
    const ObjectItem* item;
    std::uint8_t node_id;
  };
  std::vector<Wanted> wanted_;
};

TEST(DataSheets, HaveTheDefaultsOfALiveController) {
  simulation::Simulation robot(scenario("live.yaml"));
  const auto parameters = simulation::read_robot_parameters(kSource / "robots/koboshi/robot.sdf");
  const NodeKind kind = controller_kind(robot.model().model, simulation::controller_values(parameters));
  EXPECT_EQ(kind.find({0x2100, 2})->default_value, "9000");
  EXPECT_EQ(kind.find({0x1401, 5})->default_value, "500");
  for (int ms = 0; ms < 1'500; ++ms) robot.advance();
  LiveNodes nodes;
  nodes.expect(kind, sim_board::kControllerNode);
  nodes.compare([&](simulation::ObjectRequest request) { robot.request(std::move(request)); },
                [&] {
                  robot.advance();
                  return robot.take_answers();
                });
}

TEST(DataSheets, HaveTheDefaultsOfLiveDrivesAndSensors) {
  simulation::BoardWithoutController board(scenario("board.yaml"));
  const NodeKind drive = drive_kind();
  const NodeKind inertial = inertial_kind();
  const NodeKind ankle = ankle_kind();
  LiveNodes nodes;
  for (const sim_board::JointDescription& joint : board.robot().joints)
    nodes.expect(drive, joint.drive.node_id);
  nodes.expect(inertial, sim_board::kInertialNode);
  nodes.expect(ankle, sim_board::kLeftAnkleNode);
  nodes.expect(ankle, sim_board::kRightAnkleNode);
  for (int ms = 0; ms < 500; ++ms) board.advance();
  simulation::OperatorPc pc(board.board(), {});
  nodes.compare([&](simulation::ObjectRequest request) { pc.request(std::move(request)); },
                [&] {
                  pc.advance();
                  board.advance();
                  return pc.take_answers();
                });
}

}  // namespace
}  // namespace koboshi::bus
