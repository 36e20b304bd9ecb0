// A ptrace wrapper for User-mode Linux on processors with AMX; in_uml.sh preloads it.
//
// A Linux host accepts the extended state of a process (PTRACE_SETREGSET of NT_X86_XSTATE) only in full size.
// UML 6.1 keeps 2,696 bytes of it; with AMX the state has 11,008, and UML panics at its first process. This
// wrapper fills a shorter state up with the process's present one. It passes all other requests to the next
// ptrace in the link order, normally glibc's.

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

// Layout from Intel's Software Developer's Manual, volume 1, sections 13.4.1 to 13.4.3: the legacy region
// with x87 and SSE (components 0 and 1), the header, which begins with XSTATE_BV, and the other components at
// the offsets that CPUID reports.
constexpr std::size_t kXstateBvOffset = 512;
constexpr std::size_t kHeaderEnd = 576;
constexpr std::uint64_t kLegacyComponents = 3;
constexpr unsigned kFirstExtendedComponent = 2;
constexpr unsigned kComponents = 63;
constexpr unsigned kXstateLeaf = 0xD;

struct Component {
  std::size_t offset = 0;  // 0: the processor lacks this component, or it is a supervisor component
  std::size_t size = 0;
};

using Ptrace = long (*)(__ptrace_request, ...) noexcept;

Ptrace next_ptrace = nullptr;
std::array<Component, kComponents> components;
std::size_t whole_size = 0;  // size of this machine's state; 0: not yet read
// Static, because the stack of a UML kernel thread has only 16 KiB. All requests come from one thread.
alignas(std::uint64_t) std::array<std::byte, 16'384> whole;

[[gnu::constructor]] void prepare() {
  next_ptrace = reinterpret_cast<Ptrace>(dlsym(RTLD_NEXT, "ptrace"));
  for (unsigned i = kFirstExtendedComponent; i < kComponents;
       ++i) {  // read once: under virtualisation each CPUID takes microseconds
    unsigned size = 0, offset = 0, ecx = 0, edx = 0;
    if (__get_cpuid_count(kXstateLeaf, i, &size, &offset, &ecx, &edx) != 0) components[i] = {offset, size};
  }
}

// Copies the front of a state, at least its header, over a complete one. A component that the front lacks or
// truncates keeps its data and its bit in XSTATE_BV. UML read that bit without the data, and another thread
// may have run in this process since.
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

// Fills `given` up to a complete state. Returns false if it is already complete, too short to contain a
// header, or if the process has no readable state.
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
