#include "storage/formats/gltf_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <system_error>

namespace trivet::formats {
namespace {

constexpr int kMaxInt = std::numeric_limits<int>::max();

std::uint64_t length_of(const JsonNode& object, std::string_view key, int low) {
  if (!object.has(key)) return 0;
  return static_cast<std::uint64_t>(object.at(key).integer(low, kMaxInt));
}

struct ComponentType {
  int code;
  Scalar type;
};
constexpr ComponentType kComponentTypes[] = {{5120, Scalar::int8},   {5121, Scalar::uint8},
                                             {5122, Scalar::int16},  {5123, Scalar::uint16},
                                             {5125, Scalar::uint32}, {5126, Scalar::float32}};

Scalar component_type(const JsonNode& accessor, bool is_index) {
  const JsonNode named = accessor.at("componentType");
  const int code = named.integer(0, kMaxInt);
  const auto* const found = std::ranges::find(kComponentTypes, code, &ComponentType::code);
  const bool known = found != std::end(kComponentTypes);
  const bool is_unsigned = code == 5121 || code == 5123 || code == 5125;
  if (!known || (is_index ? !is_unsigned : code == 5125)) {
    named.refuse(is_index ? "expected 5121, 5123 or 5125 (unsigned integers) for indices"
                          : "expected 5126 (float), or 5120 to 5123 (integers) for vectors");
  }
  return found->type;
}

/// RFC 4648, section 4; empty if there is another character. Padding may be absent.
std::optional<std::vector<std::byte>> decode_base64(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::vector<std::byte> bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int num_bits = 0;
  for (const char c : text) {
    constexpr std::string_view kAlphabet =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t digit = kAlphabet.find(c);
    if (digit == kAlphabet.npos) return {};
    bits = (bits << 6 | static_cast<std::uint32_t>(digit)) & 0xFFFF;
    num_bits += 6;
    if (num_bits < 8) continue;
    num_bits -= 8;
    bytes.push_back(static_cast<std::byte>(bits >> num_bits & 0xFF));
  }
  return bytes;
}

/// Decode %20 and the like in URIs (RFC 3986, 2.1).
std::string decode_percent(std::string_view text) {
  const auto digit = [](char c) -> int {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
  };
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escaped =
        text[i] == '%' && i + 2 < text.size() && digit(text[i + 1]) >= 0 && digit(text[i + 2]) >= 0;
    out += escaped ? static_cast<char>(16 * digit(text[i + 1]) + digit(text[i + 2])) : text[i];
    if (escaped) i += 2;
  }
  return out;
}

/// The file below the folder that a relative URI names; empty if it leads out of the folder.
std::filesystem::path file_below(const std::filesystem::path& folder, std::string_view uri) {
  namespace fs = std::filesystem;
  const std::string name = decode_percent(uri);
  const fs::path relative(name);
  if (name.empty() || name.find('\0') != name.npos || name.find("://") != name.npos ||
      relative.is_absolute()) {
    return {};
  }
  std::error_code error;
  const fs::path base = fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, error);
  if (error) return {};
  const fs::path file = fs::weakly_canonical(base / relative, error);
  const auto differ = std::mismatch(base.begin(), base.end(), file.begin(), file.end());
  return error || differ.first != base.end() ? fs::path() : file;
}

}  // namespace

std::vector<JsonNode> elements_of(const JsonNode& root, std::string_view array) {
  return root.has(array) ? root.at(array).elements() : std::vector<JsonNode>();
}

const JsonNode& element_at(const JsonNode& index, const std::vector<JsonNode>& elements) {
  if (elements.empty()) index.refuse("expected what it names in the file, which has none");
  const std::size_t last = std::min<std::size_t>(elements.size() - 1, kMaxInt);
  return elements[static_cast<std::size_t>(index.integer(0, static_cast<int>(last)))];
}

Result<GltfParts> split_gltf(const Input& input) {
  constexpr std::size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;
  constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  if (!input.text().starts_with("glTF")) return GltfParts{input.bytes, {}};
  const auto word = [&](std::size_t at) {
    return load<std::uint32_t>(input.bytes.data() + at, std::endian::little);
  };
  if (input.bytes.size() < kHeaderBytes + kChunkHeaderBytes)
    return input.refuse("expected the header of a binary glTF file; the file is truncated");
  if (word(4) != 2) {
    return input.refuse(
        fmt::format("expected version 2 of binary glTF, found {}; export it again", word(4)));
  }
  if (word(8) != input.bytes.size()) {
    return input.refuse(fmt::format("the header announces {} bytes, found {}; the file is {}",
                                    word(8), input.bytes.size(),
                                    word(8) > input.bytes.size() ? "truncated" : "damaged"));
  }
  GltfParts parts;
  for (std::size_t at = kHeaderBytes, chunk = 0; at < input.bytes.size(); ++chunk) {
    const std::size_t left = input.bytes.size() - at;
    if (left < kChunkHeaderBytes || word(at) > left - kChunkHeaderBytes) {
      return input.refuse(fmt::format("byte {}: the chunk reaches beyond the end of the file", at));
    }
    const std::size_t length = word(at);
    const auto bytes = input.bytes.subspan(at + kChunkHeaderBytes, length);
    if (chunk == 0 && word(at + 4) != kJson)
      return input.refuse("byte 16: expected a chunk of JSON, found another");
    if (chunk == 0) parts.json = bytes;
    if (chunk == 1 && word(at + 4) == kBinary) parts.binary = bytes;
    at += kChunkHeaderBytes + length;
  }
  return parts;
}

double GltfAccessor::value(std::size_t element, std::size_t component) const noexcept {
  const double raw =
      load(first_ + element * stride_ + component * size_of(type_), type_, std::endian::little);
  if (!normalized_) return raw;
  switch (type_) {
    case Scalar::int8:
      return std::max(raw / 127, -1.0);
    case Scalar::uint8:
      return raw / 255;
    case Scalar::int16:
      return std::max(raw / 32767, -1.0);
    case Scalar::uint16:
      return raw / 65535;
    default:
      return raw;
  }
}

GltfBuffers::GltfBuffers(const Input& input, const JsonNode& root,
                         std::span<const std::byte> binary)
    : input_(input),
      binary_(binary),
      accessors_(elements_of(root, "accessors")),
      views_(elements_of(root, "bufferViews")),
      buffers_(elements_of(root, "buffers")) {}

GltfAccessor GltfBuffers::accessor(const JsonNode& named, std::string_view type) {
  const JsonNode& accessor = element_at(named, accessors_);
  if (accessor.at("type").string() != type)
    accessor.at("type").refuse(fmt::format("expected \"{}\"", type));
  const Scalar component = component_type(accessor, type == "SCALAR");
  const std::uint64_t count = length_of(accessor, "count", 1);
  if (count == 0) accessor.refuse("expected a \"count\"");
  if (count > input_.max_points()) accessor.at("count").refuse("expected no more than the limit");
  if (accessor.has("sparse"))
    accessor.refuse("is sparse, which is not read; export it without sparse accessors");
  if (!accessor.has("bufferView"))
    accessor.refuse("expected a \"bufferView\", found none; export it without compression");

  const JsonNode& view = element_at(accessor.at("bufferView"), views_);
  const JsonNode& source = element_at(view.at("buffer"), buffers_);
  const auto index = static_cast<std::size_t>(&source - buffers_.data());
  const auto bytes = buffer(index);
  const std::uint64_t begin = length_of(view, "byteOffset", 0);
  const std::uint64_t length = length_of(view, "byteLength", 1);
  if (begin > bytes.size() || length > bytes.size() - begin) {
    view.refuse(
        fmt::format("expected a range within the {} bytes of buffer {}, found {} from {} on",
                    bytes.size(), index, length, begin));
  }
  const std::uint64_t element = size_of(component) * (type == "SCALAR" ? 1 : 3);
  const std::uint64_t stride =
      view.has("byteStride") ? length_of(view, "byteStride", static_cast<int>(element)) : element;
  const std::uint64_t first = length_of(accessor, "byteOffset", 0);
  // Each is below 2^31: no overflow.
  if (first + (count - 1) * stride + element > length) {
    accessor.refuse(fmt::format(
        "expected {} elements of {} bytes within the {} bytes of its bufferView, which cannot hold "
        "them; the file is damaged",
        count, element, length));
  }
  const bool normalized = accessor.has("normalized") && accessor.at("normalized").boolean();
  return {bytes.data() + begin + first, stride, count, component, normalized};
}

std::span<const std::byte> GltfBuffers::buffer(std::size_t index) {
  const JsonNode& node = buffers_[index];
  const bool embedded = index == 0 && !node.has("uri");
  const auto bytes = embedded ? binary_ : load_uri(node, index);
  const std::uint64_t length = length_of(node, "byteLength", 1);
  if (length > bytes.size()) {
    node.refuse(fmt::format("expected {} bytes, found {}; the buffer is truncated or absent",
                            length, bytes.size()));
  }
  return bytes.first(length);
}

std::span<const std::byte> GltfBuffers::load_uri(const JsonNode& node, std::size_t index) {
  auto found = loaded_.find(index);
  if (found == loaded_.end()) {
    const std::string uri = node.at("uri").string();
    if (uri.starts_with("data:")) {
      constexpr std::string_view kMark = ";base64,";
      const std::size_t mark = uri.find(kMark);
      auto bytes = mark == uri.npos
                       ? std::nullopt
                       : decode_base64(std::string_view(uri).substr(mark + kMark.size()));
      if (!bytes) node.at("uri").refuse("expected data in base64");
      found = loaded_.emplace(index, *std::move(bytes)).first;
    } else {
      if (!input_.folder) {
        node.at("uri").refuse(
            "names another file, which cannot come along; export binary glTF (.glb)");
      }
      const std::filesystem::path file = file_below(*input_.folder, uri);
      if (file.empty()) {
        node.at("uri").refuse(
            fmt::format("expected a file beside this one or below, found {}", quote(uri)));
      }
      Result<std::vector<std::byte>> bytes = read_file(file, input_.options.max_file_bytes);
      if (!bytes) node.at("uri").refuse(bytes.error().message);
      found = loaded_.emplace(index, *std::move(bytes)).first;
    }
  }
  return found->second;
}

}  // namespace trivet::formats
