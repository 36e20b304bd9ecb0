# Cross-compiles for a Cortex-M4 without floating-point unit. The preset cortex-m4 uses it.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR cortex-m4)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)  # programs do not link without the image's start-up code and layout
set(CMAKE_EXECUTABLE_SUFFIX_CXX .elf)
# Paths in assertions and debug information are relative to the sources, so that every checkout gives the same image.
# tests/target/image_test.py searches for the addresses of functions to bound the targets of calls through pointers.
# Addresses are therefore loaded from words instead of two halves, and never only for a comparison
# (-fno-devirtualize-speculatively).
# The .su and .ci files next to the objects give the stack use and the callees of each function.
set(CMAKE_CXX_FLAGS_INIT "-mcpu=cortex-m4 -mthumb -mfloat-abi=soft -mword-relocations -fno-devirtualize-speculatively \
-fno-unwind-tables -fno-asynchronous-unwind-tables -ffunction-sections -fdata-sections \
-ffile-prefix-map=${CMAKE_SOURCE_DIR}/= -ffile-prefix-map=${CMAKE_BINARY_DIR}=. -fstack-usage -fcallgraph-info=su,da")
# Code that needs heap, exceptions or an operating system must fail to link.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-nostdlib")
set(CMAKE_CXX_STANDARD_LIBRARIES_INIT "-lc_nano -lgcc")
