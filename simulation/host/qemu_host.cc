#include "simulation/host/qemu_host.h"

#include <algorithm>
#include <bit>
#include <string>

#include <fmt/core.h>

#include "simulation/host/flash_memory.h"

namespace koboshi::simulation {
namespace {

namespace wire = cortex_m::wire;
using wire::Kind;

constexpr std::uint32_t kSysTickPeriod_ns = 40;  // 25 MHz
constexpr std::uint32_t kInstruction_ns = 64;    // -icount shift=6

std::string describe(const cortex_m::FaultRecord& record) {
  constexpr const char* kNames[] = {"NMI", "hard fault", "memory fault", "bus fault", "usage fault"};
  const bool named = record.exception >= 2 && record.exception <= 6;
  return fmt::format(
      "the firmware took a {} at pc {:#010x} (lr {:#010x}, sp {:#010x}, CFSR {:#x}, HFSR {:#x}) in behaviour "
      "state {}; the drive-enable line is {}",
      named ? kNames[record.exception - 2] : fmt::format("exception {}", record.exception),
      record.program_counter, record.link_register, record.stack_pointer, record.configurable_status,
      record.hard_status, record.behaviour_state, record.drive_enable_line != 0 ? "high" : "low");
}

cortex_m::FaultRecord decode_fault(std::span<const std::byte> body) {
  if (body.size() != 4 * wire::kFaultWords) throw std::runtime_error("the image sent half a fault record");
  std::array<std::uint32_t, wire::kFaultWords> words{};
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = wire::get_u32(body.subspan(4 * i));
  return std::bit_cast<cortex_m::FaultRecord>(words);
}

}  // namespace

FirmwareFault::FirmwareFault(const cortex_m::FaultRecord& record)
    : std::runtime_error(describe(record)), record_(record) {}

QemuHost::QemuHost(const std::filesystem::path& image, std::span<const std::byte> storage_contents,
                   std::span<const std::string> more)
    : process_(image, QemuProcess::kTimeout_ms, more) {
  program(FlashMemory(storage_contents).bytes());
  start();
}

void QemuHost::program(std::span<const std::byte> contents) {
  for (std::size_t offset = 0; offset < contents.size(); offset += wire::kMaxProgramBytes) {
    const auto piece = contents.subspan(offset, std::min(wire::kMaxProgramBytes, contents.size() - offset));
    wire::put_u32(request_body(), static_cast<std::uint32_t>(offset));
    std::ranges::copy(piece, request_body().subspan(4).begin());
    ask(Kind::kProgram, 4 + piece.size());
  }
}

void QemuHost::exchange(const hal::BatchInput& input, hal::BatchOutput& output) {
  const auto body = ask(Kind::kServe, encode(input, request_body()));
  if (body.size() < 4 || !decode(body.subspan(4), output)) {
    throw std::runtime_error("the image sent an answer that cannot be read");
  }
  last_periods_ = wire::get_u32(body);
}

std::uint32_t QemuHost::last_instructions() const {
  return (last_periods_ * kSysTickPeriod_ns + kInstruction_ns - 1) / kInstruction_ns;
}

std::uint32_t QemuHost::stack_peak_bytes() { return wire::get_u32(ask(Kind::kStackPeak, 0)); }

void QemuHost::provoke(wire::Provocation provocation) {
  request_body()[0] = static_cast<std::byte>(provocation);
  ask(Kind::kProvoke, 1);
}

std::span<const std::byte> QemuHost::ask(Kind kind, std::size_t body_size) {
  const auto request = std::span(request_).first(wire::put_header(request_, kind, body_size));
  const auto answer = process_.ask(request, answer_);
  if (!wire::is_message(answer)) throw std::runtime_error("the image sent a message of the wrong length");
  const auto body = answer.subspan(wire::kHeaderBytes);
  const Kind answered = wire::kind_of(answer);
  if (answered == Kind::kFault) throw FirmwareFault(decode_fault(body));
  if (answered != kind) throw std::runtime_error("the image answered another request");
  return body;
}

HostFactory in_qemu(const std::filesystem::path& image) {
  return [image](std::span<const std::byte> contents) { return std::make_unique<QemuHost>(image, contents); };
}

std::filesystem::path default_image() {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  const auto beside = program.parent_path() / "../../cortex-m4/bin/koboshi.elf";  // build/PRESET/bin
  if (std::filesystem::exists(beside)) return beside.lexically_normal();
  return "build/cortex-m4/bin/koboshi.elf";
}

}  // namespace koboshi::simulation
