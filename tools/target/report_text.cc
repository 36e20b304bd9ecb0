#include <cmath>

#include <fmt/core.h>

#include "tools/target/target_report.h"

namespace koboshi::tools {
namespace {

nlohmann::ordered_json to_json(const Distribution& distribution) {
  return {{"mean", distribution.mean}, {"p99", distribution.p99}, {"max", distribution.max}};
}

std::string row(std::string_view name, const Distribution& distribution) {
  return fmt::format("| {:<20} | {:>8.0f} | {:>8} | {:>8} |\n", name, distribution.mean, distribution.p99,
                     distribution.max);
}

std::string budget_table(const TargetReport& report) {
  std::string text =
      "| budget                   |   budget |     used | free, % |\n| --- | ---: | ---: | ---: |\n";
  const auto add = [&](std::string_view name, std::uint64_t budget, std::uint64_t used) {
    const double free = 100.0 - 100.0 * static_cast<double>(used) / static_cast<double>(budget);
    text += fmt::format("| {:<24} | {:>8} | {:>8} | {:>7.0f} |\n", name, budget, used, free);
  };
  const Distribution& moving = report.instructions_moving;
  add("instructions, mean", kMeanInstructions, static_cast<std::uint64_t>(std::ceil(moving.mean)));
  add("instructions, max", kMaxInstructions, moving.max);
  const auto add_bytes = [&](std::string_view name, const char* key) {
    add(name, report.image.at("budget").at(key).get<std::uint64_t>(),
        report.image.at(key).get<std::uint64_t>());
  };
  add_bytes("flash, bytes", "flash_bytes");
  add_bytes("RAM, bytes", "ram_bytes");
  add_bytes("stack, bytes", "stack_bytes");
  return text;
}

std::string instruction_table(const TargetReport& report) {
  std::string text =
      "| instructions a tick  |     mean |      p99 |      max |\n| --- | ---: | ---: | ---: |\n";
  text += row("all", report.instructions);
  text += row("while moving", report.instructions_moving);
  for (std::size_t part = 0; part < kPartNames.size(); ++part)
    text += row(kPartNames[part], report.by_part[part]);
  return text + row("rest", report.rest);
}

std::string size_table(const TargetReport& report) {
  std::string text = "| bytes                |    flash |      RAM |\n| --- | ---: | ---: |\n";
  const auto add = [&](std::string_view name, const nlohmann::ordered_json& sizes) {
    text += fmt::format("| {:<20} | {:>8} | {:>8} |\n", name, sizes.at("flash_bytes").get<std::uint64_t>(),
                        sizes.at("ram_bytes").get<std::uint64_t>());
  };
  add("all", report.image);
  for (const auto& [folder, sizes] : report.image.at("by_folder").items()) add(folder, sizes);
  return text;
}

std::string stack_table(const TargetReport& report) {
  std::string text = "| entry point          | stack, bytes |\n| --- | ---: |\n";
  const auto add = [&](std::string_view name, std::uint64_t bytes) {
    text += fmt::format("| {:<24} | {:>8} |\n", name, bytes);
  };
  for (const auto& [entry, stack] : report.image.at("by_entry_point").items()) {
    add(entry, stack.at("stack_bytes").get<std::uint64_t>());
  }
  add("worst, with an exception", report.image.at("stack_bytes").get<std::uint64_t>());
  add("deepest in the run", report.stack_peak_bytes);
  return text;
}

}  // namespace

nlohmann::ordered_json to_json(const TargetReport& report) {
  nlohmann::ordered_json by_part;
  for (std::size_t part = 0; part < kPartNames.size(); ++part)
    by_part[kPartNames[part]] = to_json(report.by_part[part]);
  by_part["rest"] = to_json(report.rest);
  nlohmann::ordered_json moving = to_json(report.instructions_moving);
  moving["ticks"] = report.ticks_moving;
  for (std::size_t part = 0; part < kPartNames.size(); ++part)
    moving["by_part"][kPartNames[part]] = to_json(report.by_part_moving[part]);
  nlohmann::ordered_json budget{{"instructions_per_tick_mean", kMeanInstructions},
                                {"instructions_per_tick_max", kMaxInstructions}};
  budget.update(report.image.at("budget"));
  return {{"ticks", report.ticks},
          {"instructions_per_tick_mean", report.instructions.mean},
          {"instructions_per_tick_p99", report.instructions.p99},
          {"instructions_per_tick_max", report.instructions.max},
          {"while_moving", moving},
          {"by_part", by_part},
          {"flash_bytes", report.image.at("flash_bytes")},
          {"ram_bytes", report.image.at("ram_bytes")},
          {"stack_bytes", report.image.at("stack_bytes")},
          {"budget", budget},
          {"stack_peak_bytes", report.stack_peak_bytes},
          {"by_folder", report.image.at("by_folder")},
          {"by_entry_point", report.image.at("by_entry_point")}};
}

std::string to_tables(const TargetReport& report) {
  return budget_table(report) + "\n" + instruction_table(report) + "\n" + size_table(report) + "\n" +
         stack_table(report);
}

std::string to_page(const TargetReport& report, const std::string& scenario) {
  return fmt::format(
      R"(# The firmware on a Cortex-M4

Written by `koboshi target-report --page docs/reference/target.md`, after `./run target`; not by hand. `--json` gives the same
as numbers.

## Budgets

Budgets of the firmware on a Cortex-M4, and what it uses of them. Instructions are those of a tick while the robot moves: 60,000 take
8 to 17 % of the 720,000 cycles that a Cortex-M4 of 72 MHz has in 10 ms, at one to two cycles an instruction. An image that exceeds
the budget of flash or RAM does not link (`hal/cortex_m/mps2/image.ld`); `tests/target` checks all five.

{}
## Instructions

The firmware was the Cortex-M4 image in QEMU, in lockstep with the robot of `{}`: {} ticks, in {} of which it moved. A
tick here is everything that the firmware executes in its 10 ms: ten calls of `service`, and `tick`. The counts are exact, and
the same in each run: under `-icount` SysTick counts instructions. They are instructions, not cycles; a Cortex-M4 takes one to
two cycles for one, more where its flash is slow. The first tick, after power-on, checks the motions in storage.

An instruction belongs to the part of the function that it was written in, wherever that was inlined, which the debug information
tells; work done for it by arithmetic, the ports or the compiler's library belongs to the part that asked for it. A plugin of QEMU
tells them apart from outside, so that the image that is measured is the image that runs. *rest* is what is in the total and in no part: reading the timer before and after each exchange.

{}
## Flash and RAM

Sizes of the image, without the robot's model and motions, which are in a flash of their own. Code and constants belong to the folder
whose library the linker took them from; those of a header, to a folder that uses it. Objects of the firmware live in
`firmware/programs/mps2`, which makes them.

{}
## Stack

The deepest path of calls from each entry point, read from the linked image; calls through pointers are bounded by
`tools/target/indirect_calls.txt`. A fault's handler starts the stack anew, so that the worst is the program's deepest path and
what the core pushes when a fault comes there. `service` and `tick` are part of the program that `reset_handler` begins.

{})",
      budget_table(report), scenario, report.ticks, report.ticks_moving, instruction_table(report),
      size_table(report), stack_table(report));
}

}  // namespace koboshi::tools
