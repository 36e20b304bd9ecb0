#pragma once

#include <cstdint>

#include "firmware/app/dictionary.h"
#include "firmware/app/motion_transfer.h"
#include "firmware/app/network_watch.h"
#include "firmware/app/requests.h"
#include "firmware/app/sensor_nodes.h"
#include "firmware/balance/feedback.h"
#include "firmware/behaviour/behaviour.h"
#include "firmware/canopen/node.h"
#include "firmware/canopen/stored_parameters.h"
#include "firmware/drive/drive_group.h"
#include "firmware/estimation/estimator.h"
#include "firmware/motion/motion_library.h"
#include "firmware/robot/model.h"
#include "firmware/storage/catalogue.h"
#include "firmware/storage/item_store.h"
#include "hal/port/board.h"

namespace koboshi::app {

// The firmware as a whole. A board constructs one, calls `service` each millisecond and `tick` after each
// tenth of them, and does nothing else. Which robot it is on and what motions it knows comes from storage
// (storage/catalogue.h).
//
// A tick passes through the stages in this order, each of which can be read and tested by itself:
//
//   samples -> Estimator -> RobotState -> Behaviour -> Decision -> Feedback -> targets of the drives
class Controller final : private canopen::NodeApplication {
 public:
  static constexpr std::uint32_t kTick_us = behaviour::Behaviour::kTick_us;

  explicit Controller(const hal::Board& board);

  // Both are never inlined, so that they can be found in an image and measured.
  //
  // Receives, answers, watches: CAN, the drives' boot, sensors, watchdog. At 1 kHz.
  [[gnu::noinline]] void service(std::uint64_t now_us);
  // One control cycle: behaviour, targets, RPDOs, SYNC, telemetry. At 100 Hz.
  [[gnu::noinline]] void tick(std::uint64_t now_us);

  // What the object dictionary shows; for tests and for the record of a run.
  const ControllerValues& values() const { return values_; }
  const robot::RobotModel& model() const { return model_; }

 private:
  // canopen::NodeApplication
  canopen::AbortCode on_write(canopen::ObjectAddress address, std::uint32_t value) override;
  canopen::Domain* domain(canopen::ObjectAddress address) override;
  canopen::AbortCode on_store(canopen::ParameterGroup group) override;
  canopen::AbortCode on_restore(canopen::ParameterGroup group) override;
  void on_reset(canopen::NmtCommand reset) override;
  bool starts_itself() override { return (values_.nmt_startup & kNoSelfStart) == 0; }
  void on_state(canopen::NmtState state) override;
  void on_rpdo(std::size_t number) override;
  void on_heartbeat(const canopen::HeartbeatEvent& event) override;
  void on_emergency(const canopen::Emergency& emergency) override { drives_.on_emergency(emergency); }
  void on_impostor(std::uint16_t identifier) override;

  void start(std::uint64_t now_us);
  FactoryStatus load_factory_parameters();
  void report_factory_parameters();
  void receive(std::uint64_t now_us);
  void read_inertial_unit(std::uint64_t now_us);
  void read_ankles(std::uint64_t now_us);
  drive::Starting starting() const;
  bool may_store() const { return behaviour::kMayStore.contains(behaviour_.state()); }

  void carry_out(const behaviour::Decision& decision, std::uint64_t now_us);
  void report(const behaviour::FaultReport& fault);
  void boot(std::uint64_t now_us);
  void command_drives(const behaviour::Decision& decision, const estimation::RobotState& robot,
                      std::uint64_t now_us);
  void publish();

  // The decision's orders that have been carried out.
  struct Done {
    std::uint16_t boots = 0;
    std::uint16_t goals = 0;
    bool fault = false;
    bool low_battery = false;
  };

  hal::Board board_;
  storage::Catalogue catalogue_;
  storage::ItemStore items_;
  robot::RobotModel model_;
  bool model_valid_;
  ControllerValues values_;
  canopen::CanPortSink sink_;
  canopen::NodeMemory<kFirstDriveRpdo + robot::kMaxJoints, kTelemetryTpdos + robot::kMaxJoints,
                      robot::kMaxJoints, 32>
      memory_;
  canopen::Node node_;
  canopen::StoredParameters parameters_;
  motion::MotionLibrary motions_;
  MotionTransfer motion_transfer_;
  drive::DriveGroup drives_;
  SensorNodes sensor_nodes_;
  NetworkWatch network_;
  estimation::Estimator estimator_;
  behaviour::Behaviour behaviour_;
  balance::Feedback feedback_;
  Requests requests_;
  hal::ImuSample imu_sample_;  // here, so that it need not be cleared each millisecond
  Done done_;
  bool started_ = false;
  std::uint64_t now_us_ = 0;
};

}  // namespace koboshi::app
