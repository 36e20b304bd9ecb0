#include "sim_board/engine/ode/library.h"

#include <cstdarg>
#include <stdexcept>

namespace koboshi::sim_board {
namespace {

thread_local std::uint64_t* warnings_of_this_thread = nullptr;

void count_message(int, const char*, va_list) {
  if (warnings_of_this_thread != nullptr) ++*warnings_of_this_thread;
}

struct OdeLibrary {
  OdeLibrary() {
    if (dInitODE2(0) == 0) throw std::runtime_error("ODE does not start");
    dSetMessageHandler(count_message);
  }
};

}  // namespace

void start_ode_in_this_thread() {
  static const OdeLibrary library;
  thread_local const bool ready = dAllocateODEDataForThread(dAllocateMaskAll) != 0;
  if (!ready) throw std::runtime_error("ODE has no memory for a thread");
}

OdeWarningCount::OdeWarningCount(std::uint64_t& warnings) { warnings_of_this_thread = &warnings; }

OdeWarningCount::~OdeWarningCount() { warnings_of_this_thread = nullptr; }

}  // namespace koboshi::sim_board
