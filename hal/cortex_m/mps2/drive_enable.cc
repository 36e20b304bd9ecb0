#include "hal/cortex_m/fault.h"
#include "hal/cortex_m/registers.h"

namespace koboshi::cortex_m {
namespace {

// The first LED of the board's FPGA (Arm DAI0386) represents the pin of the drive-enable line.
volatile std::uint32_t& leds() { return Registers::at(0x4002'8000); }
constexpr std::uint32_t kLine = 1u << 0;

}  // namespace

void set_drive_enable_line(bool high) { leds() = high ? kLine : 0; }
bool drive_enable_line() { return (leds() & kLine) != 0; }

}  // namespace koboshi::cortex_m
