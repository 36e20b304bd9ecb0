# Cross-compiles for a Cortex-M4 without floating-point unit. Used by the preset cortex-m4.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR cortex-m4)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)  # nothing links without the image's own start-up and layout
set(CMAKE_EXECUTABLE_SUFFIX_CXX .elf)
# The image is optimised as a whole: one unit at the link, so that its functions know who calls them and with which objects.
# Without -fipa-modref, what GCC concludes on the memory that a function touches: over the whole program GCC 12.2 compiles
# walk::Body::solve wrongly with it, and the robot sets off otherwise than on the host.
set(CMAKE_AR arm-none-eabi-gcc-ar)
set(CMAKE_RANLIB arm-none-eabi-gcc-ranlib)
# Paths in assertions and debug information are relative to the sources, so that every checkout gives the same image.
# Addresses are loaded from words, not in two halves: the proof of the image looks for those of functions.
# .su and .ci files, which the link leaves beside the image, tell the stack of each function and who calls whom.
set(CMAKE_CXX_FLAGS_INIT "-mcpu=cortex-m4 -mthumb -mfloat-abi=soft -mword-relocations \
-fno-unwind-tables -fno-asynchronous-unwind-tables -ffunction-sections -fdata-sections -flto -flto-partition=one -fno-ipa-modref \
-ffile-prefix-map=${CMAKE_SOURCE_DIR}/= -ffile-prefix-map=${CMAKE_BINARY_DIR}=. -fstack-usage -fcallgraph-info=su,da")
# The gate: what needs heap, exceptions or an operating system finds nothing to link with.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-nostdlib")
set(CMAKE_CXX_STANDARD_LIBRARIES_INIT "-lc_nano -lgcc")
