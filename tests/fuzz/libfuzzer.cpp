// The entry points called by libFuzzer. TRIVET_FUZZ_TARGET names the target function.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "fuzz/targets.hpp"

#define TRIVET_JOIN_NAMES(a, b) a##b
#define TRIVET_JOIN(a, b) TRIVET_JOIN_NAMES(a, b)

/// Writes the seeds to the folder FUZZ_SEEDS.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* const folder = std::getenv("FUZZ_SEEDS");
  std::size_t number = 0;
  for (const std::string& seed : trivet::fuzz::TRIVET_JOIN(TRIVET_FUZZ_TARGET, _seeds)()) {
    if (!folder) break;
    const std::filesystem::path file =
        std::filesystem::path(folder) / ("seed" + std::to_string(number++));
    std::ofstream(file, std::ios::binary) << seed;
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  trivet::fuzz::TRIVET_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
  return 0;
}
