#include "simulation/host/firmware_process.h"

#include "sim_board/sensor/sensor_node.h"

namespace koboshi::simulation {
namespace {

constexpr std::uint64_t kServicesATick = 10;

// The simulated sensors must have the node ids of a real robot's.
static_assert(hal::CanSensors::kInertialNode == sim_board::kInertialNode &&
              hal::CanSensors::kLeftAnkleNode == sim_board::kLeftAnkleNode &&
              hal::CanSensors::kRightAnkleNode == sim_board::kRightAnkleNode);

}  // namespace

void FirmwareProcess::service(std::uint64_t now_us) {
  input_.frames.clear();
  input_.imu.clear();
  input_.ankle_fresh = {};
  receive(now_us);
  input_.now_us = now_us;
  input_.tick = services_++ % kServicesATick == 0;
  input_.transmit_space.fill(hal::BatchOutput::kMaxFrames);
  if (const auto sample = sensors_.inertial(now_us))
    static_cast<void>(input_.imu.push(*sample));  // cannot fail, the list is empty
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    const auto sample = sensors_.take_ankle(side);
    if (!sample) continue;
    input_.ankles[static_cast<std::size_t>(side)] = *sample;
    input_.ankle_fresh[static_cast<std::size_t>(side)] = true;
  }
  host_.exchange(input_, output_);
  booted_ = booted_ || host_.values().behaviour.state == behaviour::State::kLimp;
  for (const hal::CanFrame& frame : output_.frames.view()) send(frame);
  transport_.flush();
}

void FirmwareProcess::receive(std::uint64_t now_us) {
  while (const auto frame = transport_.receive()) {
    if (sensors_.on_frame(*frame, now_us) || input_.frames.push(*frame)) continue;
    if (input_.can_status.receive_overruns < 0xFFFF) ++input_.can_status.receive_overruns;
  }
}

void FirmwareProcess::send(const hal::CanFrame& frame) {
  if (!transport_.send(frame, 0)) ++frames_lost_;
}

}  // namespace koboshi::simulation
