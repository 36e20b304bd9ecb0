// Writes FOLDER/can.log: a controller boots twenty drives over the simulated bus and runs them for two
// seconds. The log contains every kind of CANopen message that the robot uses.

#include <cstdio>
#include <exception>
#include <filesystem>
#include <initializer_list>
#include <vector>

#include "sim_board/can/bus.h"
#include "simulation/record/recorder.h"

namespace koboshi::sim_board {
namespace {

constexpr std::uint16_t kController = 1;
constexpr std::uint16_t kFirstDrive = 16;
constexpr std::uint16_t kDrives = 20;
constexpr std::uint64_t kCycle_us = 10'000;

hal::CanFrame make_frame(unsigned identifier, std::initializer_list<unsigned> bytes) {
  hal::CanFrame frame{
      .identifier = static_cast<std::uint16_t>(identifier), .size = 0, .remote = false, .data = {}};
  for (const unsigned byte : bytes) frame.data[frame.size++] = static_cast<std::uint8_t>(byte);
  return frame;
}

class Member : public BusNode {
 public:
  Member(Bus& bus, const AcceptanceFilter& filter) : bus_(bus), handle_(bus.attach(*this, filter, 64)) {}
  void on_frame(const hal::CanFrame&, std::uint64_t) override {}
  void send(unsigned identifier, std::initializer_list<unsigned> bytes, std::uint64_t time_us) {
    if (!bus_.queue(handle_, make_frame(identifier, bytes), time_us))
      throw std::runtime_error("transmit FIFO full");
  }

 private:
  Bus& bus_;
  NodeHandle handle_;
};

class Drive final : public Member {
 public:
  Drive(Bus& bus, std::uint16_t id)
      : Member(bus, {0x000, 0x080, static_cast<std::uint16_t>(0x200 + id),
                     static_cast<std::uint16_t>(0x600 + id)}),
        id_(id) {}

  void on_frame(const hal::CanFrame& frame, std::uint64_t time_us) override {
    if (frame.identifier == 0x080)
      send(0x180u + id_, {0x37, 0x12, position_++, 0x10, 0, 0, 0xFB, 0xFF}, time_us + 40);
    if (frame.identifier == 0x600 + id_) answer(frame, time_us + 150);
  }

 private:
  // Answers expedited SDO requests: uploads with four bytes, downloads with a confirmation. Aborts those of
  // 0x1A00.
  void answer(const hal::CanFrame& frame, std::uint64_t time_us) {
    const auto& data = frame.data;
    if (data[2] == 0x1A) {
      send(0x580u + id_, {0x80, data[1], data[2], data[3], 0x41, 0x00, 0x04, 0x06}, time_us);
    } else if (data[0] == 0x40) {
      send(0x580u + id_, {0x43, data[1], data[2], data[3], 0x92, 0x01, 0x02, 0x00}, time_us);
    } else {
      send(0x580u + id_, {0x60, data[1], data[2], data[3], 0, 0, 0, 0}, time_us);
    }
  }

  const std::uint16_t id_;
  unsigned position_ = 0;
};

void boot(Bus& bus, Member& controller, std::vector<Drive>& drives) {
  controller.send(0x700 + kController, {0x00}, 1000);
  controller.send(0x000, {0x82, 0x00}, 2000);  // NMT: reset communication of all nodes
  for (std::uint16_t i = 0; i < kDrives; ++i)
    drives[i].send(0x700u + kFirstDrive + i, {0x00}, 20'000 + 100u * i);
  for (std::uint16_t i = 0; i < kDrives; ++i) {
    const unsigned request = 0x600u + kFirstDrive + i;
    const std::uint64_t time_us = 50'000 + 5'000u * i;
    controller.send(request, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}, time_us);                  // device type
    controller.send(request, {0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0}, time_us + 500);            // vendor
    controller.send(request, {0x23, 0x00, 0x16, 0x01, 0x10, 0, 0x40, 0x60}, time_us + 1000);  // mapping
    controller.send(request, {0x2F, 0xC2, 0x60, 0x01, 10, 0, 0, 0}, time_us + 1500);  // interpolation time
    controller.send(request, {0x2F, 0x00, 0x1A, 0x00, 0, 0, 0, 0}, time_us + 2000);   // aborted
    bus.advance_to(time_us + 4'000);
  }
  controller.send(0x000, {0x01, 0x00}, 180'000);  // NMT: start all nodes
}

void run(Bus& bus, Member& controller, std::vector<Drive>& drives) {
  for (std::uint64_t cycle = 20; cycle < 220; ++cycle) {
    const std::uint64_t time_us = cycle * kCycle_us;
    const auto target = static_cast<unsigned>(cycle);
    for (std::uint16_t i = 0; i < kDrives; ++i) {
      controller.send(0x200u + kFirstDrive + i, {0x0F, 0x00, target, 0x10, 0x00, 0x00}, time_us);
    }
    controller.send(0x080, {}, time_us);
    for (unsigned k = 0; k < 4; ++k)
      controller.send(0x180 + 0x100 * k + kController, {target, 0, 1, 0, 2, 0, 3, 0}, time_us);
    if (cycle % 10 == 0) {
      controller.send(0x700 + kController, {0x05}, time_us);
      for (std::uint16_t i = 0; i < kDrives; ++i)
        drives[i].send(0x700u + kFirstDrive + i, {0x05}, time_us + 6'000);
    }
    if (cycle == 100)
      drives[3].send(0x080u + kFirstDrive + 3, {0x11, 0x86, 0x21, 0, 0, 0, 0, 0}, time_us + 7'000);
    if (cycle == 110) drives[3].send(0x080u + kFirstDrive + 3, {0, 0, 0, 0, 0, 0, 0, 0}, time_us + 7'000);
    bus.advance_to(time_us + kCycle_us);
  }
}

void write_sample(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  simulation::Recorder recorder(folder, {}, simulation::WhenFull::kWait);
  Bus bus;
  bus.set_observer(&recorder);
  Member controller(bus, AcceptanceFilter::all());
  std::vector<Drive> drives;
  drives.reserve(kDrives);  // the bus keeps pointers to the elements
  for (std::uint16_t i = 0; i < kDrives; ++i)
    drives.emplace_back(bus, static_cast<std::uint16_t>(kFirstDrive + i));
  boot(bus, controller, drives);
  run(bus, controller, drives);
  recorder.close();
}

}  // namespace
}  // namespace koboshi::sim_board

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: can_log_sample FOLDER\n", stderr);
    return 2;
  }
  try {
    koboshi::sim_board::write_sample(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
