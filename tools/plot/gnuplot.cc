#include "tools/plot/gnuplot.h"

#include <spawn.h>
#include <sys/wait.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string_view>

#include "sim_board/input/text.h"
#include "tools/plot/figure.h"

extern char** environ;

namespace koboshi::tools {
namespace {

constexpr std::array kPalette{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                              "#E69F00", "#56B4E9", "#000000", "#8C8C8C"};

// This process' environment in a locale that has UTF-8: without one gnuplot cannot convert a label's letters.
std::vector<char*> utf8_environment() {
  static char locale[] = "LC_ALL=C.UTF-8";
  std::vector<char*> variables{locale};
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (!std::string_view(*variable).starts_with("LC_ALL=")) variables.push_back(*variable);
  }
  variables.push_back(nullptr);
  return variables;
}

std::string number(double value) { return std::isnan(value) ? "NaN" : sim::number_text(value); }

}  // namespace

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "'";
}

std::string palette_colour(std::size_t number) { return kPalette[number % kPalette.size()]; }

void write_block(std::ostream& out, const std::string& name, const std::vector<Point>& points) {
  out << name << " << END\n";
  for (const Point& point : points) out << number(point.x) << ' ' << number(point.y) << '\n';
  out << "END\n";
}

std::string open_page(const std::filesystem::path& file, int width_px, int height_px) {
  const std::string terminal = file.extension() == ".svg" ? "svg" : "pngcairo";
  return "set terminal " + terminal + " background 'white' noenhanced font 'DejaVu Sans,11' size " +
         std::to_string(width_px) + "," + std::to_string(height_px) + "\nset output " +
         quoted(file.string()) + "\n";
}

std::string axes_style() {
  return "set encoding utf8\n"
         "set border 3 linecolor '#606060'\n"
         "set tics nomirror out scale 0.6 textcolor '#303030'\n"
         "set grid linetype 1 linewidth 0.6 linecolor '#E4E4E4'\n";
}

void run_gnuplot(const std::string& script, const std::filesystem::path& without_extension) {
  std::string file = without_extension.string() + ".gnuplot";
  if (!(std::ofstream(file) << script << std::flush)) throw PlotError("cannot write " + file);
  std::string program = "gnuplot";
  char* const arguments[] = {program.data(), file.data(), nullptr};
  pid_t child = 0;
  const int error =
      posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments, utf8_environment().data());
  if (error == ENOENT) throw PlotError("no figures: gnuplot is not installed (apt install gnuplot-nox)");
  if (error != 0) throw PlotError("no figures: gnuplot does not start: " + std::string(std::strerror(error)));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw PlotError("gnuplot failed; its script is " + file);
  }
  std::filesystem::remove(file);  // what failed stays, to be looked at
}

}  // namespace koboshi::tools
