# Uses ccache and mold if they are installed. Neither changes what the programs do. Packages are linked by the compiler's own
# linker, so that their bytes do not depend on mold.

find_program(KOBOSHI_CCACHE ccache)
if(KOBOSHI_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER AND NOT CMAKE_CXX_CLANG_TIDY AND NOT CMAKE_CROSSCOMPILING)
  # Not for the Cortex-M4: ccache does not store the .ci files, from which the bound of the image's stack is computed.
  # Paths below the source tree are hashed relative to it, so that all clones share the cache.
  # The sloppiness is what ccache requires for precompiled headers; no source here uses __TIME__.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1
      CCACHE_SLOPPINESS=pch_defines,time_macros ${KOBOSHI_CCACHE})
endif()

find_program(KOBOSHI_MOLD mold)
if(KOBOSHI_MOLD AND NOT KOBOSHI_PACKAGE AND NOT CMAKE_CROSSCOMPILING AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_link_options(-fuse-ld=mold)
endif()

# GCC spends a tenth of its time on collecting memory that it will soon need again. Where there is enough for all cores, it
# begins at 1 GB; the code is the same. Packages do without it, because debug information names the compiler's options.
cmake_host_system_information(RESULT koboshi_memory_MiB QUERY TOTAL_PHYSICAL_MEMORY)
cmake_host_system_information(RESULT koboshi_cores QUERY NUMBER_OF_LOGICAL_CORES)
math(EXPR koboshi_wanted_MiB "3000 * ${koboshi_cores}")
if(koboshi_memory_MiB GREATER koboshi_wanted_MiB)
  set(KOBOSHI_ENOUGH_MEMORY ON)
else()
  set(KOBOSHI_ENOUGH_MEMORY OFF)
endif()
option(KOBOSHI_LARGE_HEAP "Let GCC use more memory and less time" ${KOBOSHI_ENOUGH_MEMORY})
if(KOBOSHI_LARGE_HEAP AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT KOBOSHI_PACKAGE AND NOT CMAKE_CROSSCOMPILING)
  add_compile_options("SHELL:--param ggc-min-heapsize=1000000")
endif()
