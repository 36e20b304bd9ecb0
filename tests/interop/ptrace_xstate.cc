// A ptrace for User-mode Linux on processors with AMX; in_uml.sh preloads it.
//
// A Linux host takes the extended state of a process (PTRACE_SETREGSET of NT_X86_XSTATE) only as a whole.
// UML 6.1 keeps 2,696 bytes of it; with AMX it has 11,008, and UML panics at its first process. This ptrace
// completes a shorter state by what the process has. It passes all other requests on to the next ptrace, as a
// rule glibc's.

#include <cpuid.h>
#include <dlfcn.h>
#include <elf.h>
#include <sys/ptrace.h>
#include <sys/uio.h>

#include <array>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace {

// Intel's Software Developer's Manual, volume 1, sections 13.4.1 to 13.4.3: the legacy region with x87 and
// SSE (components 0 and 1), the header, which begins with XSTATE_BV, and the other components where CPUID
// says.
constexpr std::size_t kXstateBvOffset = 512;
constexpr std::size_t kHeaderEnd = 576;
constexpr std::uint64_t kLegacyComponents = 3;
constexpr unsigned kFirstExtendedComponent = 2;
constexpr unsigned kComponents = 63;
constexpr unsigned kXstateLeaf = 0xD;

struct Component {
  std::size_t offset = 0;  // 0: this processor has no such component, or it is the supervisor's alone
  std::size_t size = 0;
};

using Ptrace = long (*)(__ptrace_request, ...) noexcept;

Ptrace next_ptrace = nullptr;
std::array<Component, kComponents> components;
std::size_t whole_size = 0;  // of this machine's states; 0: not yet known
// Not on the stack: that of a UML kernel thread has 16 KiB. All requests come from one thread.
alignas(std::uint64_t) std::array<std::byte, 16'384> whole;

[[gnu::constructor]] void prepare() {
  next_ptrace = reinterpret_cast<Ptrace>(dlsym(RTLD_NEXT, "ptrace"));
  for (unsigned i = kFirstExtendedComponent; i < kComponents;
       ++i) {  // once: in a virtual machine each CPUID takes microseconds
    unsigned size = 0, offset = 0, ecx = 0, edx = 0;
    if (__get_cpuid_count(kXstateLeaf, i, &size, &offset, &ecx, &edx) != 0) components[i] = {offset, size};
  }
}

// Lays the front of a state, of at least a header, over a whole one. A component that the front lacks or cuts
// off keeps its data and its bit in XSTATE_BV: UML saw that bit without the data, and another thread may have
// run in this process since.
void overlay(const std::byte* front, std::size_t front_size) {
  std::uint64_t kept_bits = 0;
  std::memcpy(&kept_bits, &whole[kXstateBvOffset], sizeof kept_bits);
  std::uint64_t bits = 0;
  std::memcpy(&bits, front + kXstateBvOffset, sizeof bits);

  std::memcpy(whole.data(), front, kHeaderEnd);
  std::uint64_t laid_over = kLegacyComponents;
  for (unsigned i = kFirstExtendedComponent; i < kComponents; ++i) {
    const auto [offset, size] = components[i];
    if (offset == 0 || offset + size > front_size) continue;
    std::memcpy(&whole[offset], front + offset, size);
    laid_over |= std::uint64_t{1} << i;
  }
  bits = (bits & laid_over) | (kept_bits & ~laid_over);
  std::memcpy(&whole[kXstateBvOffset], &bits, sizeof bits);
}

// False where the state is as large as this machine's, or too short to say what it holds, or the process has
// none to be read.
bool complete(pid_t pid, const iovec& given, iovec& completed) {
  if (given.iov_len < kHeaderEnd || (whole_size != 0 && given.iov_len >= whole_size)) return false;
  completed = {whole.data(), whole.size()};
  if (next_ptrace(PTRACE_GETREGSET, pid, NT_X86_XSTATE, &completed) != 0) return false;
  whole_size = completed.iov_len;
  if (given.iov_len >= whole_size) return false;
  overlay(static_cast<const std::byte*>(given.iov_base), given.iov_len);
  return true;
}

}  // namespace

extern "C" long ptrace(__ptrace_request request, ...) noexcept {
  std::va_list rest;
  va_start(rest, request);
  const pid_t pid = va_arg(rest, pid_t);
  void* const address = va_arg(rest, void*);
  void* data = va_arg(rest, void*);
  va_end(rest);
  iovec completed;
  if (request == PTRACE_SETREGSET && reinterpret_cast<std::uintptr_t>(address) == NT_X86_XSTATE &&
      complete(pid, *static_cast<const iovec*>(data), completed)) {
    data = &completed;
  }
  return next_ptrace(request, pid, address, data);
}
