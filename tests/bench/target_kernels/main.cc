// Instructions of the fixed-point kernels on the Cortex-M4, against the same in soft float. Run in QEMU under
// -icount shift=6, where SysTick counts instructions; docs/experiment/kernels.md has the command and the
// results.
#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>

#include "hal/cortex_m/mps2/semihosting.h"
#include "hal/cortex_m/startup.h"
#include "hal/cortex_m/systick.h"
#include "tests/bench/target_kernels/kernel.h"

namespace koboshi::cortex_m {
namespace {

using bench::Contestant;
using bench::Kernel;

constexpr std::size_t kCases = 256;
constexpr std::uint32_t kPeriod_ns = 40;       // of SysTick
constexpr std::uint32_t kInstruction_ns = 64;  // -icount shift=6

struct Cost {
  std::uint32_t mean = 0;
  std::uint32_t max = 0;
};

using Cases = std::array<std::array<std::uint32_t, 2>, kCases>;

std::uint32_t nothing(std::uint32_t, std::uint32_t) { return 0; }

std::uint32_t instructions(std::uint32_t periods) {
  return (periods * kPeriod_ns + kInstruction_ns - 1) / kInstruction_ns;
}

// From before the call to after it, together with what reading the timer takes.
[[gnu::noinline]] std::uint32_t periods_of(Kernel kernel, std::uint32_t a, std::uint32_t b) {
  const std::uint32_t start = SysTick::now();
  static_cast<void>(kernel(a, b));
  return SysTick::elapsed(start, SysTick::now());
}

// Beyond a function that does nothing.
Cost measure(Kernel kernel, const Cases& cases) {
  const std::uint32_t empty = instructions(periods_of(nothing, 0, 0));
  std::uint32_t sum = 0;
  Cost cost;
  for (const auto& [a, b] : cases) {
    const std::uint32_t taken = instructions(periods_of(kernel, a, b)) - empty;
    sum += taken;
    cost.max = std::max(cost.max, taken);
  }
  cost.mean = (sum + kCases / 2) / kCases;
  return cost;
}

// The same fractions for every kernel: a linear congruential generator (Numerical Recipes, 7.1).
void draw(const Contestant& contestant, Cases& cases) {
  std::uint32_t state = 20080114;
  for (auto& pair : cases) {
    for (std::uint32_t& argument : pair) {
      state = state * 1'664'525 + 1'013'904'223;
      argument = contestant.argument(state, 0);
    }
  }
}

class Table {
 public:
  void open() { file_ = semihosting::open("/dev/stdout", semihosting::Mode::kWrite); }
  void put(const char* text) {
    static_cast<void>(semihosting::write(file_, std::as_bytes(std::span(text, std::strlen(text)))));
  }
  void put(std::uint32_t number) {
    std::array<char, 12> text{};
    std::to_chars(text.data(), text.data() + text.size() - 1, number);
    put(text.data());
  }
  void put(const Contestant& contestant, const Cost& cost) {
    put("| ");
    put(contestant.name);
    put(" | ");
    put(cost.mean);
    put(" | ");
    put(cost.max);
    put(" ");
  }

 private:
  int file_ = -1;
};

}  // namespace

void run_image() {
  static Cases cases;
  static Table table;
  SysTick::start();
  table.open();
  table.put(
      "| fixed point | mean | max | soft float | mean | max |\n| --- | ---: | ---: | --- | ---: | ---: "
      "|\n");
  for (std::size_t i = 0; i < bench::fixed_kernels().size(); ++i) {
    for (const Contestant* contestant : {&bench::fixed_kernels()[i], &bench::float_kernels()[i]}) {
      draw(*contestant, cases);
      table.put(*contestant, measure(contestant->kernel, cases));
    }
    table.put("|\n");
  }
  semihosting::exit();
}

}  // namespace koboshi::cortex_m
