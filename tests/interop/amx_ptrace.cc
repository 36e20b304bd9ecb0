// A preloaded ptrace that emulates a kernel on a processor with AMX, for tests on processors without: it
// enlarges the extended state to the size with AMX and refuses the requests that such a kernel refuses.

#include <dlfcn.h>
#include <elf.h>
#include <sys/ptrace.h>
#include <sys/uio.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace {

using Ptrace = long (*)(__ptrace_request, ...) noexcept;

constexpr std::size_t kAmxStateSize = 11'008;  // size on Sapphire Rapids: tile data, 8,192 bytes, at 2,816

Ptrace next_ptrace = nullptr;

[[gnu::constructor]] void prepare() { next_ptrace = reinterpret_cast<Ptrace>(dlsym(RTLD_NEXT, "ptrace")); }

}  // namespace

extern "C" long ptrace(__ptrace_request request, ...) noexcept {
  std::va_list rest;
  va_start(rest, request);
  const pid_t pid = va_arg(rest, pid_t);
  void* const address = va_arg(rest, void*);
  void* const data = va_arg(rest, void*);
  va_end(rest);
  const bool is_xstate = reinterpret_cast<std::uintptr_t>(address) == NT_X86_XSTATE;
  iovec* const state = static_cast<iovec*>(data);
  if (request == PTRACE_SETREGSET && is_xstate && state->iov_len < kAmxStateSize) {
    errno = EFAULT;
    return -1;
  }
  const std::size_t asked =
      request == PTRACE_GETREGSET && is_xstate ? std::min(state->iov_len, kAmxStateSize) : 0;
  const long result = next_ptrace(request, pid, address, data);
  if (asked != 0 && result == 0 && state->iov_len < asked) {
    std::memset(static_cast<std::byte*>(state->iov_base) + state->iov_len, 0, asked - state->iov_len);
    state->iov_len = asked;
  }
  return result;
}
