/// Compile one loop for several instruction sets and choose at run time.
#pragma once

/// Put before a hot function whose loops the compiler vectorizes: the loader picks the widest clone
/// that the processor has. Off under sanitizers, whose runtimes start after the loader's choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(TRIVET_NO_SIMD_CLONES)
#define TRIVET_SIMD_CLONES __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
#else
#define TRIVET_SIMD_CLONES
#endif
