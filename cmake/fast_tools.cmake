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
