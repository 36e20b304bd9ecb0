#include "tools/plot/gnuplot.h"

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>

#include "base/file/output_file.h"
#include "base/text/text.h"
#include "hal/linux/child_process.h"
#include "hal/linux/file_descriptor.h"
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

std::string number(double value) { return std::isnan(value) ? "NaN" : number_text(value); }

// output_png, output_svg
std::string output_variable(const std::string& extension) { return "output_" + extension.substr(1); }

// A file in memory, which this process and its children can open by its path: gnuplot does not notice a full
// disk.
class MemoryFile {
 public:
  explicit MemoryFile(const char* name)
      : descriptor_(hal::checked(::memfd_create(name, 0), "memory for a figure")),
        path_("/proc/self/fd/" + std::to_string(descriptor_.number())) {}

  const std::string& path() const { return path_; }
  int descriptor() const { return descriptor_.number(); }
  void write(std::string_view text) const {
    if (::write(descriptor_.number(), text.data(), text.size()) != static_cast<ssize_t>(text.size()))
      throw PlotError("no memory for the script of a figure");
  }
  std::string content() const {
    std::ifstream stream(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

 private:
  hal::FileDescriptor descriptor_;
  std::string path_;
};

// Runs gnuplot. Its standard error goes into `messages`.
bool succeeds(const std::string& script_path, const MemoryFile& messages) {
  const std::vector<char*> environment = utf8_environment();
  pid_t child = 0;
  const int error = hal::spawn({"gnuplot", script_path},
                               {.errors = messages.descriptor(), .environment = environment.data()}, child);
  if (error == ENOENT) throw PlotError("gnuplot is not installed (apt install gnuplot-nox)");
  if (error != 0) throw PlotError("gnuplot does not start: " + std::string(std::strerror(error)));
  const int status = hal::wait_for_child(child);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

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

std::string open_page(const std::string& extension, int width_px, int height_px) {
  const std::string terminal = extension == ".svg" ? "svg" : "pngcairo";
  return "set terminal " + terminal + " background 'white' noenhanced font 'DejaVu Sans,11' size " +
         std::to_string(width_px) + "," + std::to_string(height_px) + "\nset output " +
         output_variable(extension) + "\n";
}

std::string axes_style() {
  return "set encoding utf8\n"
         "set border 3 linecolor '#606060'\n"
         "set tics nomirror out scale 0.6 textcolor '#303030'\n"
         "set grid linetype 1 linewidth 0.6 linecolor '#E4E4E4'\n";
}

void run_gnuplot(const std::string& script, const std::filesystem::path& without_extension) {
  const MemoryFile program("script");
  std::vector<MemoryFile> pages;
  std::string in_memory;
  std::string on_disk;
  for (const char* const extension : kPageExtensions) {
    const std::string& path = pages.emplace_back(extension).path();
    in_memory += output_variable(extension) + " = " + quoted(path) + "\n";
    on_disk += output_variable(extension) + " = " + quoted(without_extension.string() + extension) + "\n";
  }
  program.write(in_memory + script);
  const MemoryFile messages("messages");
  if (!succeeds(program.path(), messages)) {
    const std::string file = without_extension.string() + ".gnuplot";
    write_whole_file(file, on_disk + script);
    throw PlotError("gnuplot failed; its script is " + file + "; " + one_line(messages.content()));
  }
  for (std::size_t i = 0; i < pages.size(); ++i) {
    write_whole_file(without_extension.string() + kPageExtensions[i], pages[i].content());
  }
}

}  // namespace koboshi::tools
