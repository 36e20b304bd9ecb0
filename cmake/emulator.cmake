# Programs that this machine's kernel does not run, such as 32-bit ones on some virtual machines, are run by QEMU.
include(CheckCXXSourceRuns)

if(CMAKE_CXX_FLAGS MATCHES "-m32" AND NOT CMAKE_CROSSCOMPILING)
  check_cxx_source_runs("int main() { return 0; }" KOBOSHI_RUNS_ITS_PROGRAMS)
  if(NOT KOBOSHI_RUNS_ITS_PROGRAMS)
    find_program(KOBOSHI_QEMU_I386 qemu-i386 REQUIRED)
    set(CMAKE_CROSSCOMPILING_EMULATOR ${KOBOSHI_QEMU_I386})
  endif()
endif()
