// The door that libFuzzer comes in by. TRIVET_FUZZ_TARGET names the function to be searched.
#include <cstddef>
#include <cstdint>

#include "fuzz/targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  trivet::fuzz::TRIVET_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
  return 0;
}
