#pragma once

// KOBOSHI_VECTOR_CLONES before a function compiles it twice, for processors with AVX2 and for all others; the
// program chooses when it starts. Both have the same bits: without -ffast-math and with -ffp-contract=off a
// compiler may neither reorder a sum nor fuse a product into it, so the width of the registers changes how
// many elements are computed at once, and nothing else.
//
// Sanitizers instrument the function that chooses, which runs before they are ready.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__clang__)
#define KOBOSHI_VECTOR_CLONES [[gnu::target_clones("avx2", "default")]]
#else
#define KOBOSHI_VECTOR_CLONES
#endif
