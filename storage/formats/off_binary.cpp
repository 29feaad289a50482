#include "storage/formats/off_binary.hpp"

#include <fmt/format.h>

#include <bit>
#include <optional>
#include <utility>

#include "storage/files/scalar.hpp"
#include "storage/formats/faces.hpp"

namespace trivet::formats {
namespace {

constexpr std::size_t kNumberBytes = 4;

class OffBinaryReader {
 public:
  OffBinaryReader(const Input& input, std::size_t begin) : input_(input), at_(begin) {}

  Result<Cloud> read(const OffKeyword& keyword) {
    const auto vertices = integer(), faces = integer(), edges = integer();
    if (!vertices || !faces || !edges) return refuse("the numbers of vertices, faces and edges");
    if (*vertices > input_.max_points()) return input_.refuse_count(*vertices);
    const std::size_t in_a_vertex = 3 + (keyword.has_normals ? 3 : 0) + keyword.num_others();
    // A face takes at least its number of corners and of color components.
    const std::uint64_t announced = (*vertices * in_a_vertex + *faces * 2) * kNumberBytes;
    if (announced > remaining()) {
      return input_.refuse(fmt::format(
          "expected {} vertices and {} faces, which take at least {} bytes, found {}; the file is "
          "truncated",
          *vertices, *faces, announced, remaining()));
    }

    read_vertices(*vertices, in_a_vertex, keyword.has_normals);
    for (std::uint64_t i = 0; i < *faces; ++i) {
      TRIVET_TRY(read_face(*vertices));
    }
    if (remaining() > 0) {
      return input_.refuse_byte(at_,
                                fmt::format("expected the end of the file behind the last face, "
                                            "found {} bytes more",
                                            remaining()));
    }
    TRIVET_TRY(std::move(faces_).put_into(cloud_, input_));
    return std::move(cloud_);
  }

 private:
  std::size_t remaining() const noexcept { return input_.bytes.size() - at_; }
  /// Error at the last integer.
  Error refuse(std::string_view expected) const {
    return input_.refuse_byte(number_at_, fmt::format("expected {}, found {}", expected, found()));
  }

  std::string found() const {
    const std::size_t size = input_.bytes.size() - number_at_;
    if (size < kNumberBytes) return fmt::format("the last {} bytes of the file", size);
    return fmt::format("{}",
                       load<std::int32_t>(input_.bytes.data() + number_at_, std::endian::big));
  }

  /// The next integer; empty if negative or at the end of the file.
  std::optional<std::uint64_t> integer() {
    number_at_ = at_;
    if (remaining() < kNumberBytes) return {};
    at_ += kNumberBytes;
    const auto value = load<std::int32_t>(input_.bytes.data() + number_at_, std::endian::big);
    return value < 0 ? std::nullopt : std::optional(static_cast<std::uint64_t>(value));
  }

  Eigen::Vector3f vector() {
    Eigen::Vector3f v;
    for (Eigen::Index i = 0; i < 3; ++i, at_ += kNumberBytes)
      v[i] = load<float>(input_.bytes.data() + at_, std::endian::big);
    return v;
  }

  /// Pre: the file has enough bytes.
  void read_vertices(std::uint64_t count, std::size_t numbers_of_each, bool with_normals) {
    cloud_.points.reserve(count);
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::size_t begin = at_;
      cloud_.points.push_back(vector());
      if (with_normals) cloud_.normals.push_back(vector());
      at_ = begin + numbers_of_each * kNumberBytes;
    }
  }

  Result<void> read_face(std::uint64_t num_vertices) {
    const auto size = integer();
    if (!size || *size > remaining() / kNumberBytes)
      return refuse("the number of a face's corners");
    faces_.begin();
    for (std::uint64_t corner = 0; corner < *size; ++corner) {
      const auto index = integer();
      if (!index || *index >= num_vertices)
        return refuse(fmt::format("the index of a vertex below {}", num_vertices));
      faces_.add(static_cast<std::uint32_t>(*index));
    }
    const auto color = integer();
    if (!color || *color > 4 || *color > remaining() / kNumberBytes)
      return refuse("the number of a color's components, up to 4");
    at_ += *color * kNumberBytes;
    return {};
  }

  const Input& input_;
  std::size_t at_, number_at_ = 0;
  Cloud cloud_;
  Faces faces_;
};

}  // namespace

Result<Cloud> read_off_binary(const Input& input, const OffKeyword& keyword, std::size_t begin) {
  return OffBinaryReader(input, begin).read(keyword);
}

}  // namespace trivet::formats
