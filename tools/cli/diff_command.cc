#include "tools/cli/diff_command.h"

#include <filesystem>
#include <memory>

#include <fmt/core.h>

#include "tools/diff/report.h"

namespace koboshi::tools {
namespace {

struct DiffArguments {
  std::filesystem::path a;
  std::filesystem::path b;
};

}  // namespace

void add_diff_command(CLI::App& program, int& exit_status) {
  auto arguments = std::make_shared<DiffArguments>();
  CLI::App* command = program.add_subcommand("diff", "Compare two runs: where they part, and how");
  command->footer(
      "Compares trace.csv and can.log to the last bit. Exit status: 0 the same, 1 different, 2 bad input.\n\n"
      "Example:\n"
      "  koboshi run scenarios/walk.yaml --out runs/host\n"
      "  koboshi run scenarios/walk.yaml --out runs/target --controller qemu\n"
      "  koboshi diff runs/host runs/target\n");
  command->add_option("RUN_A", arguments->a, "The folder of a run's results")->required();
  command->add_option("RUN_B", arguments->b, "Another")->required();
  command->callback([arguments, &exit_status] {
    const RunComparison comparison = compare_runs(arguments->a, arguments->b);
    fmt::print("{}", comparison.report);
    exit_status = comparison.same ? 0 : 1;
  });
}

}  // namespace koboshi::tools
