// Loops for the vectors of the machine at hand, in a program that runs on any.
#pragma once

#include <cstddef>

/// Before a function: compiles it twice, for any x86-64 and for AVX2, and chooses when the program
/// starts. Both compute the same floats (-ffp-contract=off). Without GCC and glibc: once.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
#define WAVEFOG_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define WAVEFOG_VECTOR_CLONES
#endif
