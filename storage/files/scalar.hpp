/// Numbers of any width and byte order, as in binary PLY and PCD files.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace trivet::formats {

enum class Scalar { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

constexpr std::size_t size_of(Scalar type) noexcept {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

/// Read an unaligned value. Pre: size_of its type bytes lie at `from`.
template <class T>
T load(const std::byte* from, std::endian order) noexcept {
  std::byte bytes[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes[i] = from[order == std::endian::native ? i : sizeof(T) - 1 - i];
  }
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

inline double load(const std::byte* from, Scalar type, std::endian order) noexcept {
  switch (type) {
    case Scalar::int8:
      return load<std::int8_t>(from, order);
    case Scalar::uint8:
      return load<std::uint8_t>(from, order);
    case Scalar::int16:
      return load<std::int16_t>(from, order);
    case Scalar::uint16:
      return load<std::uint16_t>(from, order);
    case Scalar::int32:
      return load<std::int32_t>(from, order);
    case Scalar::uint32:
      return load<std::uint32_t>(from, order);
    case Scalar::int64:
      return static_cast<double>(load<std::int64_t>(from, order));
    case Scalar::uint64:
      return static_cast<double>(load<std::uint64_t>(from, order));
    case Scalar::float32:
      return load<float>(from, order);
    case Scalar::float64:
      return load<double>(from, order);
  }
  return 0;
}

}  // namespace trivet::formats
