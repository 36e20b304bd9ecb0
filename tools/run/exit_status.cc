#include "tools/run/exit_status.h"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>

#include "base/file/output_file.h"
#include "base/file/standard_streams.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "simulation/motion_language/parse/diagnostic.h"
#include "tools/run/interrupt.h"

namespace koboshi::tools {
namespace {

void check_arguments(const std::string& name, std::span<char* const> arguments) {
  for (std::size_t i = 1; i < arguments.size(); ++i)
    if (find_invalid_utf8(arguments[i]) != std::string_view::npos)
      throw InputError(name, 0, "argument " + std::to_string(i) + ", " + one_line(arguments[i]),
                       "UTF-8 text");
}

// Printed text may still be in a buffer, and the disk full.
void close_standard_output() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw WriteError("standard output", errno);
}

int reported(const std::string& name, const std::exception& error, int status) {
  print_error("{}: {}\n", name, utf8_text(error.what()));
  return status;
}

}  // namespace

int exit_status_of(const std::string& name, std::span<char* const> arguments,
                   const std::function<int()>& body) {
  reserve_standard_streams();
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error like a full disk
  try {
    check_arguments(name, arguments);
    const int status = body();
    close_standard_output();
    return status;
  } catch (const simulation::MotionError& error) {
    write_to_standard_error(simulation::print(error.diagnostics()));
    return kBadInput;
  } catch (const InputError& error) {
    print_error("{}\n", error.what());
    return kBadInput;
  } catch (const WriteError& error) {
    return reported(name, error, kBadInput);
  } catch (const std::filesystem::filesystem_error& error) {
    // Without the library's words around them.
    print_error("{}: cannot use {}: {}\n", name, utf8_text(error.path1().string()), error.code().message());
    return kBadInput;
  } catch (const Interrupted& interrupted) {
    return reported(name, interrupted, kSignalled + interrupted.signal());
  } catch (const std::invalid_argument& error) {
    return reported(name, error, kBadInput);
  } catch (const std::exception& error) {
    // fmt::print throws when the buffer of standard output cannot be written.
    if (std::ferror(stdout) != 0) return reported(name, WriteError("standard output", errno), kBadInput);
    return reported(name, error, kFailed);
  }
}

}  // namespace koboshi::tools
