/// Compile one loop for several instruction sets and choose at run time.
#pragma once

/// Marks a hot function whose loops the compiler vectorizes: the loader chooses the widest clone
/// that the processor supports. Off under sanitizers, whose runtimes start after the loader's
/// choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(TRIVET_NO_SIMD_CLONES)
#define TRIVET_SIMD_CLONES __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
#else
#define TRIVET_SIMD_CLONES
#endif

/// Marks a loop over columns that do not overlap. No iteration reads what another one writes, so
/// the compiler vectorizes without comparing addresses.
#if defined(__clang__)
#define TRIVET_SIMD_LOOP _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define TRIVET_SIMD_LOOP _Pragma("GCC ivdep")
#else
#define TRIVET_SIMD_LOOP
#endif
