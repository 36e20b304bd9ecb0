#include "cli/commands.h"

#include <filesystem>
#include <memory>

#include <fmt/core.h>

#include "tools/diff/report.h"

namespace koboshi::cli {
namespace {

struct DiffArguments {
  std::filesystem::path a;
  std::filesystem::path b;
};

}  // namespace

void add_diff_command(CLI::App& program, Invocation& invocation) {
  auto arguments = std::make_shared<DiffArguments>();
  CLI::App* command = program.add_subcommand("diff", "Compare two runs and show where they first differ");
  command->footer(
      R"(Compares trace.csv and can.log byte by byte. Exit status: 0 the same, 1 different, 2 bad input.

Example:
  koboshi run scenarios/walk.yaml --out runs/host
  koboshi run scenarios/walk.yaml --out runs/target --controller qemu
  koboshi diff runs/host runs/target
)");
  command->add_option("RUN_A", arguments->a, "The folder of a run's results")->required();
  command->add_option("RUN_B", arguments->b, "The folder of another run's results")->required();
  command->callback([arguments, &invocation] {
    const tools::RunComparison comparison = tools::compare_runs(arguments->a, arguments->b);
    fmt::print("{}", comparison.report);
    invocation.exit_status = comparison.same ? 0 : 1;
  });
}

}  // namespace koboshi::cli
