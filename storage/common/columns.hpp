/// 64-byte aligned columns: the storage of every structure of arrays.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace trivet {

/// Allocator with 64-byte alignment, the size of a cache line and of the widest vectors.
template <class T>
struct ColumnAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlignment{64};

  ColumnAllocator() = default;
  template <class U>
  ColumnAllocator(const ColumnAllocator<U>&) noexcept {}  // NOLINT: rebinding is implicit

  T* allocate(std::size_t n) {
    if (n > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(::operator new(n * sizeof(T), kAlignment));
  }
  void deallocate(T* pointer, std::size_t) noexcept { ::operator delete(pointer, kAlignment); }
  bool operator==(const ColumnAllocator&) const = default;
};

/// One channel of a structure of arrays.
template <class T>
using Column = std::vector<T, ColumnAllocator<T>>;

}  // namespace trivet
