// Policies on the Cortex-M4: the instructions of one cycle against the bound of the validator, and a digest
// of their outputs, which must be that of the host. Run in QEMU under -icount shift=6, where SysTick counts
// instructions; tests/target/policy_test.py has the command.
#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>

#include "hal/cortex_m/mps2/semihosting.h"
#include "hal/cortex_m/startup.h"
#include "hal/cortex_m/systick.h"
#include "tests/unit/firmware/policy/sample_policy.h"

namespace koboshi::cortex_m {
namespace {

constexpr std::uint32_t kPeriod_ns = 40;       // of SysTick
constexpr std::uint32_t kInstruction_ns = 64;  // -icount shift=6
constexpr int kCycles = 50;

int output_file = -1;

void put(const char* text) {
  static_cast<void>(semihosting::write(output_file, std::as_bytes(std::span(text, std::strlen(text)))));
}

void put(std::uint32_t number, int base = 10) {
  std::array<char, 12> text{};
  std::to_chars(text.data(), text.data() + text.size() - 1, number, base);
  put(text.data());
}

// The most that a cycle takes, of a policy and its watchdog.
std::uint32_t instructions_of(test::SamplePolicies& samples) {
  static policy::Residual residual;
  residual.reset();
  std::uint32_t most = 0;
  for (int cycle = 0; cycle < kCycles; ++cycle) {
    samples.draw_robot();
    const std::uint32_t start = SysTick::now();
    residual.advance(samples.policy(), samples.observation());
    const std::uint32_t periods = SysTick::elapsed(start, SysTick::now());
    most = std::max(most, (periods * kPeriod_ns + kInstruction_ns - 1) / kInstruction_ns);
  }
  return most;
}

}  // namespace

void run_image() {
  static test::SamplePolicies samples;
  SysTick::start();
  output_file = semihosting::open("/dev/stdout", semihosting::Mode::kWrite);
  put("| policy | at most | measured |\n| --- | ---: | ---: |\n");
  for (std::size_t i = 0; i < test::kSampleShapes.size(); ++i) {
    const bool valid = samples.open(i);
    put("| ");
    put(static_cast<std::uint32_t>(i));
    put(" | ");
    put(valid ? samples.policy().work() : 0);
    put(" | ");
    put(valid ? instructions_of(samples) : 0);
    put(" |\n");
  }
  const std::uint64_t digest = test::digest_of(samples);
  put("digest ");
  put(static_cast<std::uint32_t>(digest >> 32), 16);
  put(" ");
  put(static_cast<std::uint32_t>(digest), 16);
  put("\n");
  semihosting::exit();
}

}  // namespace koboshi::cortex_m
