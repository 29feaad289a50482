/// Appending numbers to a buffer as little-endian bytes.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>

namespace trivet::formats {

template <class T>
void append(std::string& out, T value) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
  out.append(bytes.data(), bytes.size());
}

template <class T>
void append(std::string& out, const Eigen::Matrix<T, 3, 1>& v) {
  append(out, v.x());
  append(out, v.y());
  append(out, v.z());
}

}  // namespace trivet::formats
