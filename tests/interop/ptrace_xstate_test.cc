// Tests the ptrace wrapper that in_uml.sh preloads. AVX represents AMX here: both are components outside the
// legacy region and the header.

#include <cpuid.h>
#include <elf.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace {

using State = std::vector<std::byte>;

constexpr std::size_t kXmm0Offset = 160;
constexpr std::size_t kXstateBvOffset = 512;
constexpr std::size_t kHeaderEnd = 576;
constexpr std::uint64_t kX87AndSse = 3;
constexpr std::uint64_t kAvx = 4;

std::uint64_t xstate_bv(const State& state) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &state[kXstateBvOffset], sizeof bits);
  return bits;
}

void set_xstate_bv(State& state, std::uint64_t bits) {
  std::memcpy(&state[kXstateBvOffset], &bits, sizeof bits);
}

// Calls the kernel directly, without the wrapper under test.
long raw_set_state(pid_t pid, State state) {
  iovec given{state.data(), state.size()};
  return syscall(SYS_ptrace, PTRACE_SETREGSET, pid, NT_X86_XSTATE, &given);
}

long set_state(pid_t pid, State state) {
  iovec given{state.data(), state.size()};
  return ptrace(PTRACE_SETREGSET, pid, NT_X86_XSTATE, &given);
}

// Fixture with a stopped child process that the test traces.
class PtraceXstate : public testing::Test {
 protected:
  void SetUp() override {
    child_ = fork();
    ASSERT_GE(child_, 0);
    if (child_ == 0) {
      if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(errno);
      raise(SIGSTOP);
      _exit(0);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child_, &status, 0), child_);
    if (!WIFSTOPPED(status))
      GTEST_SKIP() << "this machine lets nobody be traced: " << strerror(WEXITSTATUS(status));
    unsigned eax = 0, ebx = 0, ecx = 0, edx = 0;
    __get_cpuid_count(0xD, 2, &eax, &ebx, &ecx, &edx);
    avx_size_ = eax;
    avx_offset_ = ebx;
    if (avx_offset_ != kHeaderEnd) GTEST_SKIP() << "this processor has no AVX behind the header";
  }
  void TearDown() override {
    if (child_ <= 0) return;
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
  }

  State state() const {
    State state(65'536);
    iovec taken{state.data(), state.size()};
    EXPECT_EQ(syscall(SYS_ptrace, PTRACE_GETREGSET, child_, NT_X86_XSTATE, &taken), 0);
    state.resize(taken.iov_len);
    return state;
  }
  // Sets a state with AVX in use in the child and returns it.
  State with_avx() const {
    State whole = state();
    set_xstate_bv(whole, xstate_bv(whole) | kX87AndSse | kAvx);
    fill_avx(whole, std::byte{0xA5});
    EXPECT_EQ(raw_set_state(child_, whole), 0) << strerror(errno);
    EXPECT_EQ(state(), whole);
    return whole;
  }
  void fill_avx(State& state, std::byte value) const {
    const std::size_t end = std::min(state.size(), avx_offset_ + avx_size_);
    std::fill(state.begin() + static_cast<std::ptrdiff_t>(avx_offset_),
              state.begin() + static_cast<std::ptrdiff_t>(end), value);
  }

  pid_t child_ = -1;
  std::size_t avx_offset_ = 0, avx_size_ = 0;
};

TEST_F(PtraceXstate, KernelTakesNoShorterStates) {
  State front = state();
  front.resize(kHeaderEnd);
  EXPECT_EQ(raw_set_state(child_, front), -1);
  EXPECT_EQ(errno, EFAULT) << "what UML reports as errno = 14";
}

TEST_F(PtraceXstate, CompletesAShorterState) {
  State expected = with_avx();
  expected[kXmm0Offset] = std::byte{0x5A};
  State front = expected;
  front.resize(kHeaderEnd);
  set_xstate_bv(front, kX87AndSse);  // the state of a process that has not used AVX yet
  ASSERT_EQ(set_state(child_, front), 0) << strerror(errno);
  EXPECT_EQ(state(), expected);
}

TEST_F(PtraceXstate, EnablesNoComponentWithoutData) {
  State expected = with_avx();
  set_xstate_bv(expected, xstate_bv(expected) & ~kAvx);
  ASSERT_EQ(raw_set_state(child_, expected), 0) << strerror(errno);
  expected = state();
  ASSERT_EQ(xstate_bv(expected) & kAvx, 0u);
  State front = expected;
  front.resize(kHeaderEnd);
  set_xstate_bv(front, xstate_bv(front) | kAvx);
  ASSERT_EQ(set_state(child_, front), 0) << strerror(errno);
  EXPECT_EQ(state(), expected);
}

TEST_F(PtraceXstate, AcceptsCompleteComponents) {
  State expected = with_avx();
  fill_avx(expected, std::byte{0x3C});
  State front = expected;
  front.resize(avx_offset_ + avx_size_);  // the whole state on processors with no component behind AVX
  ASSERT_EQ(set_state(child_, front), 0) << strerror(errno);
  EXPECT_EQ(state(), expected);
}

TEST_F(PtraceXstate, IgnoresTruncatedComponents) {
  const State expected = with_avx();
  State front = expected;
  front.resize(avx_offset_ + avx_size_ - sizeof(std::uint64_t));
  fill_avx(front, std::byte{0x3C});
  ASSERT_EQ(set_state(child_, front), 0) << strerror(errno);
  EXPECT_EQ(state(), expected);
}

TEST_F(PtraceXstate, ForwardsCompleteStates) {
  State expected = with_avx();
  set_xstate_bv(expected, kX87AndSse);
  ASSERT_EQ(set_state(child_, expected), 0) << strerror(errno);
  EXPECT_EQ(xstate_bv(state()), kX87AndSse) << "nothing is kept of a component that the caller could give";
}

TEST_F(PtraceXstate, LeavesErrorsToTheKernel) {
  State bad = state();
  bad[kXstateBvOffset + 8] = std::byte{1};  // XCOMP_BV: the compacted format
  EXPECT_EQ(set_state(child_, bad), -1);
  EXPECT_EQ(errno, EINVAL);
  bad.resize(kHeaderEnd);
  EXPECT_EQ(set_state(child_, bad), -1);
  EXPECT_EQ(errno, EINVAL);
  bad.resize(kHeaderEnd - sizeof(std::uint64_t));
  EXPECT_EQ(set_state(child_, bad), -1);
  EXPECT_EQ(errno, EFAULT);
  EXPECT_EQ(set_state(getpid(), state()), -1);
  EXPECT_EQ(errno, ESRCH);
}

// glibc's ptrace returns the peeked word; the system call writes it to its fourth argument.
TEST_F(PtraceXstate, ForwardsOtherRequests) {
  long word = -1;  // the child has a copy at the same address
  errno = EIO;
  EXPECT_EQ(ptrace(PTRACE_POKEDATA, child_, &word, 0x1234'5678'9ABC'DEF0), 0);
  EXPECT_EQ(ptrace(PTRACE_PEEKDATA, child_, &word, nullptr), 0x1234'5678'9ABC'DEF0);
  EXPECT_EQ(errno, 0);
  EXPECT_EQ(ptrace(PTRACE_PEEKDATA, child_, nullptr, nullptr), -1);
  EXPECT_EQ(errno, EIO);
  user_regs_struct registers = {};
  EXPECT_EQ(ptrace(PTRACE_GETREGS, child_, nullptr, &registers), 0);
  EXPECT_EQ(ptrace(PTRACE_PEEKUSER, child_, offsetof(user, regs.rip), nullptr),
            static_cast<long>(registers.rip));
  iovec general{&registers, sizeof registers};
  EXPECT_EQ(ptrace(PTRACE_SETREGSET, child_, NT_PRSTATUS, &general), 0);
  EXPECT_EQ(word, -1);
}

}  // namespace
