# Test programs that this machine's kernel does not run, such as 32-bit ones on some virtual machines, run in QEMU. A
# project that adds this one as a subdirectory needs no QEMU.
include(CheckCXXSourceRuns)

if(PROJECT_IS_TOP_LEVEL AND BUILD_TESTING AND CMAKE_CXX_FLAGS MATCHES "-m32" AND NOT CMAKE_CROSSCOMPILING)
  check_cxx_source_runs("int main() { return 0; }" KOBOSHI_RUNS_ITS_PROGRAMS)
  if(NOT KOBOSHI_RUNS_ITS_PROGRAMS)
    find_program(KOBOSHI_QEMU_I386 qemu-i386 REQUIRED)
    set(CMAKE_CROSSCOMPILING_EMULATOR ${KOBOSHI_QEMU_I386})
  endif()
endif()
