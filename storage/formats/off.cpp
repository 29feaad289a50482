#include "storage/formats/readers.hpp"

namespace trivet::formats {
Result<Cloud> read_off(const Input& input) { return input.refuse("this format is not read yet"); }
}  // namespace trivet::formats
