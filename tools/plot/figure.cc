#include "tools/plot/figure.h"

#include <spawn.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "tools/plot/columns.h"
#include "tools/plot/gnuplot_script.h"

extern char** environ;

namespace koboshi::tools {
namespace {

// Runs gnuplot on a script; throws PlotError unless it succeeds.
void run_gnuplot(const std::filesystem::path& script) {
  std::string program = "gnuplot";
  std::string argument = script.string();
  char* const arguments[] = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  const int error = posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments, environ);
  if (error == ENOENT) throw PlotError("no figures: gnuplot is not installed (apt install gnuplot-nox)");
  if (error != 0) throw PlotError("no figures: gnuplot does not start: " + std::string(std::strerror(error)));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw PlotError("gnuplot failed; its script is " + script.string());
  }
}

}  // namespace

void draw(const Figure& figure, const std::filesystem::path& csv_file,
          const std::filesystem::path& without_extension) {
  std::vector<std::string> names{figure.x_column};
  for (const Panel& panel : figure.panels) {
    for (const Series& series : panel.series) names.push_back(series.column);
  }
  const std::string text = gnuplot_script(figure, read_columns(csv_file, names), without_extension);
  const std::filesystem::path script = without_extension.string() + ".gnuplot";
  if (!(std::ofstream(script) << text << std::flush)) throw PlotError("cannot write " + script.string());
  run_gnuplot(script);
  std::filesystem::remove(script);  // what failed stays, to be looked at
}

}  // namespace koboshi::tools
