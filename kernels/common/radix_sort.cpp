#include "kernels/common/radix_sort.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "storage/common/precondition.hpp"
#include "storage/common/stop.hpp"

namespace trivet::kernels {

void radix_sort(Column<std::uint64_t>& keys, Column<std::uint32_t>& values, std::uint64_t max_key,
                RadixScratch& scratch) {
  TRIVET_REQUIRE(keys.size() == values.size(), "one value per key");
  // 2^11 counters stay in the first-level cache beside the keys that stream past.
  constexpr int kMaxDigitBits = 11;
  constexpr std::size_t kSteps = 1 << 20;  // keys between two checks
  const std::size_t n = keys.size();
  const int key_bits = static_cast<int>(std::bit_width(max_key));
  const int num_passes = (key_bits + kMaxDigitBits - 1) / kMaxDigitBits;
  if (n < 2 || num_passes == 0) return;
  const int digit_bits = (key_bits + num_passes - 1) / num_passes;
  const std::uint64_t mask = (std::uint64_t{1} << digit_bits) - 1;

  scratch.keys.resize(n);
  scratch.values.resize(n);
  for (int pass = 0; pass < num_passes; ++pass) {
    const int shift = pass * digit_bits;
    std::array<std::uint32_t, std::size_t{1} << kMaxDigitBits> next{};
    check_stop();
    for (const std::uint64_t key : keys) ++next[(key >> shift) & mask];
    std::uint32_t total = 0;
    for (std::uint32_t& slot : next) {
      const std::uint32_t count = slot;
      slot = total;
      total += count;
    }
    for (std::size_t first = 0; first < n; first += kSteps) {
      check_stop();
      for (std::size_t i = first; i < std::min(n, first + kSteps); ++i) {
        const std::uint32_t to = next[(keys[i] >> shift) & mask]++;
        scratch.keys[to] = keys[i];
        scratch.values[to] = values[i];
      }
    }
    keys.swap(scratch.keys);
    values.swap(scratch.values);
  }
}

}  // namespace trivet::kernels
