# Cross-compiles for a Cortex-M4 without floating-point unit. Used by the preset cortex-m4.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR cortex-m4)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)  # nothing links without the image's own start-up and layout
set(CMAKE_EXECUTABLE_SUFFIX_CXX .elf)
# Paths in assertions and debug information are relative to the sources, so that every checkout gives the same image.
# tests/target/image_test.py looks for the addresses of functions, to know what calls through pointers may reach: they are loaded
# from words, not in two halves, and none is loaded only to be compared with a pointer (-fno-devirtualize-speculatively).
# .su and .ci files beside the objects tell the stack of each function and who calls whom.
set(CMAKE_CXX_FLAGS_INIT "-mcpu=cortex-m4 -mthumb -mfloat-abi=soft -mword-relocations -fno-devirtualize-speculatively \
-fno-unwind-tables -fno-asynchronous-unwind-tables -ffunction-sections -fdata-sections \
-ffile-prefix-map=${CMAKE_SOURCE_DIR}/= -ffile-prefix-map=${CMAKE_BINARY_DIR}=. -fstack-usage -fcallgraph-info=su,da")
# The gate: what needs heap, exceptions or an operating system finds nothing to link with.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-nostdlib")
set(CMAKE_CXX_STANDARD_LIBRARIES_INIT "-lc_nano -lgcc")
