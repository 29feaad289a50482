/// The parts of a glTF file: its document, its buffers, and the accessors into them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "storage/common/clamped_integer.hpp"
#include "storage/common/result.hpp"
#include "storage/files/file.hpp"
#include "storage/files/input.hpp"
#include "storage/files/json_file.hpp"
#include "storage/files/scalar.hpp"

namespace trivet::formats {

/// The JSON document and the binary buffer of a GLB file.
struct GltfParts {
  std::span<const std::byte> json, binary;
};

/// Errors: bad_data (truncated, or chunks that are not as the container's version 2 says).
/// Source: Khronos Group, glTF 2.0 Specification, 4.4.
Result<GltfParts> split_gltf(const Input& input);

/// The elements of an array of the document; empty if it is absent.
std::vector<JsonNode> elements_of(const JsonNode& root, std::string_view array);

/// The element whose index a member holds. Throws JsonFault if there is none.
const JsonNode& element_at(const JsonNode& index, const std::vector<JsonNode>& elements);

/// The data of an accessor, checked to lie within its buffer: `count` elements of several values.
class GltfAccessor {
 public:
  GltfAccessor(const std::byte* first, std::size_t stride, std::size_t count, Scalar type,
               bool normalized)
      : first_(first), stride_(stride), count_(count), type_(type), normalized_(normalized) {}

  std::size_t size() const noexcept { return count_; }
  /// The value; normalized integers as fractions of the largest one (glTF 2.0, 3.11).
  double value(std::size_t element, std::size_t component) const noexcept;
  std::uint32_t index(std::size_t element) const noexcept {
    return clamped_integer(value(element, 0), 0U, std::numeric_limits<std::uint32_t>::max());
  }

 private:
  const std::byte* first_;
  std::size_t stride_, count_;
  Scalar type_;
  bool normalized_;
};

/// Buffers of the document. Each is read at first use and lives as long as this object.
class GltfBuffers {
 public:
  GltfBuffers(const Input& input, const JsonNode& root, std::span<const std::byte> binary);

  /// The accessor that a member of some object names. Throws JsonFault with the path of the fault:
  /// an index or range out of bounds, an unexpected type, compressed data.
  ///
  /// type   "SCALAR" for indices, "VEC3" for vectors
  GltfAccessor accessor(const JsonNode& named, std::string_view type);

 private:
  std::span<const std::byte> buffer(std::size_t index);
  std::span<const std::byte> load_uri(const JsonNode& node, std::size_t index);

  const Input& input_;
  std::span<const std::byte> binary_;
  std::vector<JsonNode> accessors_, views_, buffers_;
  std::map<std::size_t, std::vector<std::byte>> loaded_;
};

}  // namespace trivet::formats
