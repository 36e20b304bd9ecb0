#include <cassert>

#include "firmware/app/controller.h"
#include "hal/cortex_m/fault.h"
#include "hal/cortex_m/mps2/link.h"
#include "hal/cortex_m/startup.h"
#include "hal/cortex_m/systick.h"
#include "hal/flash/flash_model.h"
#include "hal/lockstep/batch_board.h"

namespace koboshi::cortex_m {
namespace {

using wire::Kind;

[[gnu::section(".storage")]] std::byte storage_memory[hal::FlashModel::kSize_bytes];

// After a reset by a fault, the host still waits for the answer to its last request.
void report_fault(Link& link) {
  const FaultRecord* fault = last_fault();
  if (fault == nullptr) return;
  const auto* const words = reinterpret_cast<const std::uint32_t*>(fault);
  for (std::size_t i = 0; i < wire::kFaultWords; ++i) wire::put_u32(link.body().subspan(4 * i), words[i]);
  clear_fault();
  link.answer(Kind::kFault, 4 * wire::kFaultWords);
}

void fill_storage(Link& link, hal::FlashModel& storage) {
  for (;;) {
    const Link::Request request = link.receive();
    if (request.kind == Kind::kStart) return;
    assert(request.kind == Kind::kProgram && request.body.size() >= 4);
    const bool fits = storage.program(wire::get_u32(request.body), request.body.subspan(4));
    assert(fits);
    static_cast<void>(fits);
    link.answer(Kind::kProgram, 0);
  }
}

void serve(Link& link, std::span<const std::byte> request, hal::BatchBoard& board,
           app::Controller& firmware) {
  static hal::BatchInput input;
  const bool valid = decode(request, input);
  assert(valid);
  static_cast<void>(valid);
  board.begin(input);
  const std::uint32_t start = SysTick::now();
  firmware.service(input.now_us);
  if (input.tick) firmware.tick(input.now_us);
  const std::uint32_t periods = SysTick::elapsed(start, SysTick::now());
  note_behaviour_state(static_cast<std::uint32_t>(firmware.values().behaviour.state));
  set_drive_enable_line(board.end().drive_enabled);
  wire::put_u32(link.body(), periods);
  link.answer(Kind::kServe, 4 + encode(board.end(), link.body().subspan(4)));
}

void provoke(wire::Provocation provocation) {
  switch (provocation) {
    case wire::Provocation::kUndefinedInstruction:
      __builtin_trap();
    case wire::Provocation::kBadAddress:
      Registers::at(0x3000'0000) = 1;  // an address without a device
      return;
    case wire::Provocation::kStackOverflow:
      asm volatile("1: push {r0-r3}\n b 1b");
  }
}

void answer(Link& link, const Link::Request& request, hal::BatchBoard& board, app::Controller& firmware) {
  switch (request.kind) {
    case Kind::kServe:
      return serve(link, request.body, board, firmware);
    case Kind::kStackPeak:
      wire::put_u32(link.body(), stack_peak_bytes());
      return link.answer(Kind::kStackPeak, 4);
    case Kind::kProvoke:
      return provoke(static_cast<wire::Provocation>(request.body[0]));
    default:
      assert(false);
  }
}

}  // namespace

// All objects are function-local statics: constructed in this order by code, without heap and without dynamic
// initialisers.
void run_image() {
  SysTick::start();
  static Link link;
  link.open();
  report_fault(link);
  static hal::FlashModel storage(storage_memory);
  fill_storage(link, storage);
  static hal::BatchBoard board(storage);
  static app::Controller firmware(board.board());
  link.answer(Kind::kStart, 0);
  for (;;) answer(link, link.receive(), board, firmware);
}

}  // namespace koboshi::cortex_m
