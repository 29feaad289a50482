#include "storage/formats/declared_size.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>
#include <vector>

#include "storage/files/gunzip.hpp"
#include "storage/files/inflater.hpp"
#include "storage/files/input.hpp"
#include "storage/files/scalar.hpp"
#include "storage/files/text.hpp"
#include "storage/formats/npy_header.hpp"
#include "storage/formats/pcd_header.hpp"
#include "storage/formats/ply_header.hpp"

namespace trivet {
namespace {

using formats::Input;
using formats::load;
using formats::Scalar;

constexpr std::size_t kHeadBytes = 1 << 16;   ///< length of the decompressed head, which includes
                                              ///< the header
constexpr std::uint64_t kTriangleBytes = 50;  ///< size of a triangle in a binary STL file, with
                                              ///< three corners
constexpr std::uint64_t kFewestBytes = 4;     ///< fewest bytes of a point or pixel, if unknown

std::uint64_t number_at(std::span<const std::byte> bytes, std::size_t at, Scalar type,
                        std::endian order) {
  const std::size_t size = type == Scalar::uint16 ? 2 : 4;
  if (bytes.size() < size || at > bytes.size() - size) return 0;
  return static_cast<std::uint64_t>(load(bytes.data() + at, type, order));
}

std::uint64_t pixels_of_png(std::span<const std::byte> bytes) {
  constexpr std::size_t kWidth = 16, kHeight = 20;  // PNG specification, 5.3 and 11.2.2
  return number_at(bytes, kWidth, Scalar::uint32, std::endian::big) *
         number_at(bytes, kHeight, Scalar::uint32, std::endian::big);
}

/// Size from the first directory: TIFF 6.0, section 2.
std::uint64_t pixels_of_tiff(std::span<const std::byte> bytes) {
  constexpr std::uint64_t kWidth = 256, kHeight = 257, kShort = 3;
  constexpr std::size_t kEntryBytes = 12;
  if (bytes.size() < 8) return 0;
  const std::endian order = bytes[0] == std::byte{'I'} ? std::endian::little : std::endian::big;
  const std::size_t directory = number_at(bytes, 4, Scalar::uint32, order);
  const std::uint64_t num_entries = number_at(bytes, directory, Scalar::uint16, order);
  std::uint64_t width = 0, height = 0;
  for (std::uint64_t k = 0; k < num_entries; ++k) {
    const std::size_t entry = directory + 2 + k * kEntryBytes;
    const std::uint64_t tag = number_at(bytes, entry, Scalar::uint16, order);
    const bool is_short = number_at(bytes, entry + 2, Scalar::uint16, order) == kShort;
    const std::uint64_t value =
        number_at(bytes, entry + 8, is_short ? Scalar::uint16 : Scalar::uint32, order);
    if (tag == kWidth) width = value;
    if (tag == kHeight) height = value;
  }
  return width * height;
}

/// Points, and faces, which take about as much memory.
std::uint64_t points_of_ply(const Input& input) {
  const auto header = parse_ply_header(input);
  std::uint64_t sum = 0;
  for (const char* const name : {"vertex", "face", "tristrips", "range_grid"}) {
    const formats::PlyElement* const element = header ? header->find(name) : nullptr;
    if (element) sum += std::min(element->count, input.max_points());
  }
  return sum;
}

std::uint64_t values_of_npy(const Input& input, std::uint64_t num_bytes) {
  const auto header = parse_npy_header(input);
  if (!header) return num_bytes / kFewestBytes;
  std::uint64_t product = 1;
  for (std::size_t d = 0; d < std::min<std::size_t>(header->shape.size(), 2); ++d)
    product *= header->shape[d];
  const bool is_image = header->shape.size() == 3 || header->shape.back() > 6;
  return is_image ? product : header->shape.front();
}

/// Number of ends of lines: \n, or \r if there are more of those. Counts in bytes, which a vector
/// holds the most of, since the service counts before it decides whether there is room.
std::uint64_t count_line_ends(std::string_view text) {
  constexpr std::size_t kMostOfAByte = 255;
  std::uint64_t feeds = 0, returns = 0;
  for (std::size_t at = 0; at < text.size(); at += kMostOfAByte) {
    std::uint8_t block_feeds = 0, block_returns = 0;
    for (const char c : text.substr(at, kMostOfAByte)) {
      block_feeds = static_cast<std::uint8_t>(block_feeds + (c == '\n'));
      block_returns = static_cast<std::uint8_t>(block_returns + (c == '\r'));
    }
    feeds += block_feeds;
    returns += block_returns;
  }
  return std::max(feeds, returns);
}

/// Number of points of a text with this head and size, at one point per line.
std::uint64_t lines_of(std::string_view head, std::uint64_t num_bytes) {
  const std::uint64_t lines = count_line_ends(head);
  if (head.size() >= num_bytes) return lines + 1;
  return num_bytes / (head.size() / (lines + 1) + 1);
}

/// head       at least the first bytes
/// num_bytes  size of the whole
std::uint64_t points_of(const Input& head, std::uint64_t num_bytes, std::string_view extension) {
  const std::span<const std::byte> bytes = head.bytes;
  if (extension == "png") return pixels_of_png(bytes);
  if (extension == "tif" || extension == "tiff") return pixels_of_tiff(bytes);
  if (extension == "npy") return values_of_npy(head, num_bytes);
  if (extension == "ply") return points_of_ply(head);
  if (extension == "glb" || extension == "gltf") return num_bytes / kFewestBytes;
  if (extension == "pcd") {
    const auto header = parse_pcd_header(head);
    return header ? header->num_points : 0;
  }
  if (head.text().substr(0, kHeadBytes).find('\0') == std::string_view::npos)
    return lines_of(head.text(), num_bytes);
  return extension == "stl" ? 3 * num_bytes / kTriangleBytes : num_bytes / kFewestBytes;
}

/// The first bytes of gzip data after decompression.
std::vector<std::byte> head_of(std::span<const std::byte> packed) {
  std::vector<std::byte> head(kHeadBytes);
  Inflater inflater(PackedFrame::gzip, packed);
  std::size_t size = 0;
  for (std::size_t produced = 1; size < head.size() && produced > 0; size += produced) {
    if (inflater.step(std::span(head).subspan(size), produced) != Z_OK) {
      size += produced;
      break;
    }
  }
  head.resize(size);
  return head;
}

}  // namespace

DeclaredSize declared_size(std::span<const std::byte> bytes, const std::filesystem::path& name,
                           const ReadOptions& options) {
  const bool is_packed = is_gzip(bytes);
  const std::vector<std::byte> head = is_packed ? head_of(bytes) : std::vector<std::byte>();
  const std::span<const std::byte> first = is_packed ? std::span<const std::byte>(head) : bytes;
  std::uint64_t num_bytes = first.size();
  // RFC 1952, 2.3.1: the last four bytes are the size.
  if (is_packed && head.size() == kHeadBytes)
    num_bytes = number_at(bytes, bytes.size() - 4, Scalar::uint32, std::endian::little);
  num_bytes = std::max<std::uint64_t>(std::min(num_bytes, options.max_file_bytes), first.size());
  const bool has_gz = formats::lower_case(name.extension().string()) == ".gz";
  const std::string extension =
      formats::lower_case((has_gz ? name.stem() : name).extension().string());
  std::string_view format = options.format;
  if (format.empty() && !extension.empty()) format = std::string_view(extension).substr(1);
  if (format.empty()) format = format_by_content(first);
  const std::uint64_t points = points_of({name, first, options}, num_bytes, format);
  return {std::min(points, 2 * std::max(options.max_points, options.max_pixels)),
          is_packed ? num_bytes : 0};
}

}  // namespace trivet
