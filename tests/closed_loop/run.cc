#include "tests/closed_loop/run.h"

#include <algorithm>
#include <bit>

namespace koboshi::test {
namespace {

class Fnv1a {
 public:
  explicit Fnv1a(std::uint64_t& hash) : hash_(hash) {}

  void add(std::uint64_t value) {
    for (int i = 0; i < 8; ++i) {
      hash_ ^= value >> (8 * i) & 0xFF;
      hash_ *= 0x100'0000'01B3;
    }
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  template <typename Derived>
  void add(const Eigen::MatrixBase<Derived>& matrix) {
    for (const double value : matrix.reshaped()) add(value);
  }

 private:
  std::uint64_t& hash_;
};

}  // namespace

RobotRun::RobotRun(const simulation::Scenario& scenario) : simulation_(scenario, remember_host()) {
  board().electronics().bus().set_observer(this);
}

simulation::HostFactory RobotRun::remember_host() {
  return [this](std::span<const std::byte> contents) {
    auto host = std::make_unique<OpenHost>(contents);
    host_ = host.get();
    return host;
  };
}

void RobotRun::run_until_us(std::uint64_t end_us) {
  while (now_us() < end_us) {
    simulation_.advance();
    hash_bodies();
  }
}

bool RobotRun::run_until(const std::function<bool()>& condition, std::uint64_t limit_us) {
  while (now_us() < limit_us && !condition()) run_until_us(now_us() + 1);
  return condition();
}

bool RobotRun::run_until(behaviour::State state, std::uint64_t limit_us) {
  return run_until([&] { return behaviour().state == state; }, limit_us);
}

std::size_t RobotRun::joint(const std::string& name) const {
  return static_cast<std::size_t>(robot().find_joint(name).value());
}

int RobotRun::torque_count() const {
  int count = 0;
  for (std::size_t i = 0; i < robot().joints.size(); ++i)
    count += board().electronics().drive(i).makes_torque();
  return count;
}

int RobotRun::count_in(canopen::cia402::State state) const {
  int count = 0;
  for (std::size_t i = 0; i < robot().joints.size(); ++i)
    count += board().electronics().drive(i).state() == state;
  return count;
}

std::uint64_t RobotRun::limited_ms() const {
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < robot().joints.size(); ++i)
    total += board().electronics().drive(i).values().limited_ms;
  return total;
}

std::vector<RobotRun::Frame> RobotRun::emergencies(std::uint8_t node_id, std::uint16_t code) const {
  std::vector<Frame> found;
  for (const Frame& frame : frames_) {
    const auto emergency = canopen::decode_emergency(frame.frame);
    if (emergency && emergency->node_id == node_id && emergency->code == code) found.push_back(frame);
  }
  return found;
}

void RobotRun::on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) {
  frames_.push_back({frame, start_us, end_us});
  Fnv1a hash(hash_);
  hash.add(start_us);
  hash.add(end_us);
  hash.add(std::uint64_t{frame.identifier} << 16 | std::uint64_t{frame.size} << 8 |
           std::uint64_t{frame.remote});
  for (const std::uint8_t byte : frame.data) hash.add(std::uint64_t{byte});
}

void RobotRun::hash_bodies() {
  Fnv1a hash(hash_);
  for (std::size_t link = 0; link < robot().links.size(); ++link) {
    const sim_board::BodyState body = board().world().body(static_cast<int>(link));
    hash.add(body.X_WL.matrix());
    hash.add(body.v_WCom_W);
    hash.add(body.w_WL_W);
  }
}

simulation::Scenario quick_squat() {
  simulation::Scenario scenario = simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/squat.yaml");
  scenario.initial.release_us = kRelease_us;
  scenario.commands = {{.at_us = kEnable_us, .kind = simulation::Command::Kind::kEnable},
                       {.at_us = kPlay_us, .kind = simulation::Command::Kind::kPlay, .motion = 0}};
  return scenario;
}

simulation::Scenario hanging_squat() {
  simulation::Scenario scenario = quick_squat();
  scenario.initial.release_us.reset();
  scenario.initial.fixed_base = true;
  return scenario;
}

simulation::Scenario with_fault(simulation::Scenario scenario, simulation::Fault::Kind kind,
                                std::uint64_t at_us, const std::string& joint) {
  simulation::Fault fault;
  fault.at_us = at_us;
  fault.kind = kind;
  fault.target.text = joint;
  scenario.faults.push_back(fault);
  return scenario;
}

}  // namespace koboshi::test
