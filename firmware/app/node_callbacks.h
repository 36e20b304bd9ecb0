#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/app/decision_executor.h"
#include "firmware/app/dictionary.h"
#include "firmware/app/motion_transfer.h"
#include "firmware/app/network_watch.h"
#include "firmware/app/policy_transfer.h"
#include "firmware/app/requests.h"
#include "firmware/behaviour/behaviour.h"
#include "firmware/canopen/node/node.h"
#include "firmware/canopen/node/stored_parameters.h"
#include "firmware/drive/drive_group.h"
#include "firmware/motion/motion_library.h"
#include "firmware/policy/policy_slot.h"
#include "firmware/robot/model.h"
#include "firmware/storage/catalogue.h"
#include "firmware/storage/item_store.h"

namespace koboshi::app {

// Receives the callbacks of the controller's CANopen node (CiA 301). Passes requests, resets and messages of
// the drives to Requests, Behaviour and DriveGroup, and executes at once what the behaviour decides about
// them. Stores parameters (0x1010, 0x1011), motions (0x2400 to 0x2404) and the policy (0x2420
// to 0x2422).
class NodeCallbacks final : public canopen::NodeApplication {
 public:
  struct Parts {
    ControllerValues& values;
    const storage::Catalogue& catalogue;
    const robot::RobotModel& model;
    canopen::Node& node;
    storage::ItemStore& items;
    motion::MotionLibrary& motions;
    policy::PolicySlot& policy;
    drive::DriveGroup& drives;
    NetworkWatch& network;
    behaviour::Behaviour& behaviour;
    Requests& requests;
    DecisionExecutor& executor;
  };

  // All must outlive the callbacks; only references are taken, so that none needs to be constructed yet.
  explicit NodeCallbacks(const Parts& parts)
      : parts_(parts),
        parameters_(parts.items, parts.node),
        motion_transfer_(parts.items, parts.model, parts.motions),
        policy_transfer_(parts.items, parts.model, parts.policy) {}

  // Sets the time of the callbacks that follow; to be called before the node processes anything.
  void set_time(std::uint64_t now_us) { now_us_ = now_us; }
  // Continues to store parameters and to look for motions; to be called once a millisecond.
  void process() {
    parameters_.process();
    parts_.motions.process();
  }

 private:
  canopen::AbortCode on_read(canopen::ObjectAddress address, canopen::ObjectValue& value) override;
  canopen::AbortCode on_write(canopen::ObjectAddress address, std::uint32_t value) override;
  canopen::Domain* domain(canopen::ObjectAddress address) override;
  canopen::AbortCode on_store(canopen::ParameterGroup group) override;
  canopen::AbortCode on_restore(canopen::ParameterGroup group) override;
  canopen::PdoConfiguration default_pdo(canopen::PdoDirection direction, std::size_t number) override {
    return drive_pdo(direction, number, parts_.model);
  }
  std::uint32_t default_consumer(std::size_t number) override { return drive_consumer(number, parts_.model); }
  void on_reset(canopen::NmtCommand reset) override;
  bool starts_itself() override { return (parts_.values.nmt_startup & kNoSelfStart) == 0; }
  void on_state(canopen::NmtState state) override;
  bool on_rpdo(std::size_t number) override;
  bool on_rpdo_timeout(std::size_t number) override;
  void on_heartbeat(const canopen::HeartbeatEvent& event) override;
  void on_emergency(const canopen::Emergency& emergency) override { parts_.drives.on_emergency(emergency); }
  void on_impostor(std::uint16_t identifier) override;

  bool may_store() const { return behaviour::kMayStore.contains(parts_.behaviour.state()); }
  canopen::AbortCode read_policy(canopen::ObjectAddress address, canopen::ObjectValue& value);
  canopen::AbortCode erase_motion(std::uint16_t number, std::uint32_t value);
  canopen::AbortCode erase_policy(std::uint32_t value);
  void await_velocity();
  void await_stream();
  void execute_decision();
  FactoryStatus load_factory_parameters();
  void report_factory_parameters();

  const Parts parts_;
  canopen::StoredParameters parameters_;
  MotionTransfer motion_transfer_;
  PolicyTransfer policy_transfer_;
  std::uint64_t now_us_ = 0;
};

}  // namespace koboshi::app
