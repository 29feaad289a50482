/// Dot products of bytes, with processor support (AVX-512 VNNI) where available.
#pragma once

#include <cstddef>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace trivet::kernels {

/// Bytes of a code of 60 components, the most frequent size, for which loops are unrolled.
inline constexpr std::size_t kUsualStride = 64;

#if defined(__x86_64__)
#define TRIVET_BYTE_PRODUCTS __attribute__((target("avx512f,avx512bw,avx512vnni")))

inline bool has_byte_products() noexcept {
  static const bool has =
      __builtin_cpu_supports("avx512vnni") != 0 && __builtin_cpu_supports("avx512bw") != 0;
  return has;
}
#endif

}  // namespace trivet::kernels
