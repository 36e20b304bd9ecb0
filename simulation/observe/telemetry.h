#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "firmware/behaviour/state.h"
#include "firmware/drive/fault.h"
#include "firmware/robot/model.h"
#include "hal/port/side.h"
#include "sim_board/can/observer.h"
#include "sim_board/state/archive.h"

namespace koboshi::simulation {

// State of firmware and drives decoded from the bus: the controller's telemetry PDOs
// (firmware/app/dictionary.cc), the PDOs between controller and drives, and emergency messages. It uses only
// the frames, so it is the same wherever the firmware runs.
struct Telemetry {
  behaviour::State state = behaviour::State::kBoot;
  behaviour::Reason reason = behaviour::Reason::kNone;
  behaviour::Reason refusal = behaviour::Reason::kNone;  // reason of the last command's refusal, or none
  std::uint8_t motion = 0;
  drive::DriveFault drive_fault = drive::DriveFault::kNone;
  std::uint8_t faulty_joint = 0;
  double roll_rad = 0.0;  // attitude of the trunk, estimated from gyro and accelerometer
  double pitch_rad = 0.0;
  std::array<double, 3> rate_rad_per_s{};  // filtered gyro rates without bias
  std::array<double, 2> foot_load_N{};     // by Side; not a number on a robot that does not measure it
  struct FootZmp {
    double x_m = 0.0;
    double y_m = 0.0;
    bool valid = false;
  };
  std::array<FootZmp, 2> foot_zmp{};  // by Side, each in its own sole's frame
  std::array<bool, 2> contact{};      // by Side: the foot bears a load, by whatever tells the firmware
  struct Zmp {
    double x_m = 0.0;
    double y_m = 0.0;
    bool valid = false;
    hal::Side frame = hal::Side::kLeft;  // the position is in the sole frame of this foot
  };
  Zmp zmp;                          // of both feet; the frame is that of the foot with more load
  std::array<double, 3> com_S_m{};  // centre of mass from the joint angles, in the frame of `zmp`
  Zmp planned_zmp;                  // of a walk by command
  // Motion of the centre of mass in the frame of a sole, levelled.
  struct ComMotion {
    std::array<double, 2> dcm_m{};
    std::array<double, 2> dcm_error_m{};  // against the plan of a walk
    bool valid = false;
    bool compared = false;          // dcm_error_m is valid
    std::array<bool, 2> touches{};  // by Side: the foot bears load
    hal::Side frame = hal::Side::kLeft;
  };
  ComMotion com_motion;
  // Ten times a second.
  struct Place {
    double x_m = 0.0;  // of the trunk since power-on, along its first heading and to the left
    double y_m = 0.0;
    double heading_rad = 0.0;
    bool ground_valid = false;                  // of the next two
    std::array<double, 2> slope_rad{};          // along the sole's axes; positive uphill
    std::array<double, 2> attitude_zero_rad{};  // what the attitude shows beyond the slope
  };
  Place place;
  struct Joint {
    double target_rad = 0.0;
    double position_rad = 0.0;  // from the encoder
    double torque_permille = 0.0;
    std::uint16_t statusword = 0;
  };
  std::array<Joint, robot::kMaxJoints> joints{};
  std::uint64_t emergencies = 0;  // number of messages with an error, of nodes that the robot has
};

// Returns whether a node id belongs to the robot: to its controller, a drive, or one of the places of its
// sensors.
[[nodiscard]] bool has_node(const robot::RobotModel& model, std::uint8_t node_id);

class TelemetryReader final : public sim_board::BusObserver {
 public:
  // The model must outlive the reader.
  explicit TelemetryReader(const robot::RobotModel& model);

  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) override;
  const Telemetry& now() const { return telemetry_; }
  void archive(sim_board::StateArchive& archive);

 private:
  static constexpr std::uint8_t kNoJoint = 0xFF;

  void read_controller(std::uint16_t base, const hal::CanFrame& frame);
  void read_balance(std::uint16_t base, const hal::CanFrame& frame);

  const robot::RobotModel& model_;
  std::array<std::uint8_t, 128> joint_of_node_;
  Telemetry telemetry_;
};

}  // namespace koboshi::simulation
