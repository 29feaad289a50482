#include <fmt/format.h>

#include <optional>
#include <utility>

#include "storage/files/text.hpp"
#include "storage/formats/faces.hpp"
#include "storage/formats/readers.hpp"

namespace trivet::formats {
namespace {

/// Geomview's keyword [ST][C][N]OFF; 4OFF and nOFF have other than three dimensions.
struct Keyword {
  bool has_normals = false;
  std::string_view rest;  ///< a number glued to the keyword, as ModelNet's files have it
};

std::optional<Keyword> parse_keyword(std::string_view word) {
  Keyword keyword;
  const auto take = [&](std::string_view prefix) {
    if (!word.starts_with(prefix)) return false;
    word.remove_prefix(prefix.size());
    return true;
  };
  take("ST");
  take("C");
  keyword.has_normals = take("N");
  if (!take("OFF")) return {};
  keyword.rest = word;
  return keyword;
}

class OffReader {
 public:
  explicit OffReader(const Input& input) : input_(input), cursor_(input.text()) {}

  Result<Cloud> read() {
    const auto magic = next_word();
    const auto keyword = parse_keyword(magic);
    if (!keyword) return refuse("a text file that begins with OFF, COFF, NOFF or CNOFF", magic);

    const auto vertices = read_count(keyword->rest.empty() ? next_word() : keyword->rest);
    const auto faces = read_count(next_word());
    const auto edges = read_count(next_word());
    if (!vertices || !faces || !edges)
      return refuse("the numbers of vertices, faces and edges", "others");
    if (*vertices > input_.max_points()) return input_.refuse_count(*vertices);
    // A vertex takes three digits and blanks, a face one.
    if (*vertices > cursor_.remaining() / 5 || *faces > cursor_.remaining() / 2) {
      return input_.refuse(
          fmt::format("expected {} vertices and {} faces, which do not fit into the {} "
                      "bytes that follow; the file is truncated",
                      *vertices, *faces, cursor_.remaining()));
    }

    if (auto done = read_vertices(*vertices, keyword->has_normals); !done) return done.error();
    if (auto done = read_faces(*faces); !done) return done.error();
    if (auto done = std::move(faces_).put_into(cloud_, input_); !done) return done.error();
    return std::move(cloud_);
  }

 private:
  Error refuse(std::string_view expected, std::string_view found) const {
    return input_.refuse_line(cursor_.line(),
                              fmt::format("expected {}, found {}", expected, quote(found)));
  }

  /// The next word of this line, empty at its end or at a comment.
  std::string_view word() {
    if (in_comment_) return {};
    const auto found = cursor_.word();
    in_comment_ = found.starts_with('#');
    return in_comment_ ? std::string_view{} : found;
  }
  bool next_line() {
    in_comment_ = false;
    return cursor_.next_line();
  }
  std::string_view next_word() {
    auto found = word();
    while (found.empty() && next_line()) found = word();
    return found;
  }

  static std::optional<std::uint64_t> read_count(std::string_view word) {
    const auto count = parse_integer(word);
    return count && *count >= 0 ? std::optional(static_cast<std::uint64_t>(*count)) : std::nullopt;
  }

  /// Three numbers, the first of which is `first`.
  Result<Eigen::Vector3f> read_vector(std::string_view first) {
    Eigen::Vector3f v;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const auto found = i == 0 ? first : word();
      const auto number = parse_number(found);
      if (!number) return refuse("three numbers on a line", found);
      v[i] = to_float(*number);
    }
    return v;
  }

  /// One a line; colors and texture coordinates may follow.
  Result<void> read_vertices(std::uint64_t count, bool with_normals) {
    cloud_.points.reserve(count);
    for (std::uint64_t i = 0; i < count; ++i) {
      next_line();
      const auto point = read_vector(next_word());
      if (!point) return point.error();
      cloud_.points.push_back(*point);
      if (!with_normals) continue;
      const auto normal = read_vector(word());
      if (!normal) return normal.error();
      cloud_.normals.push_back(*normal);
    }
    return {};
  }

  /// One a line: the number of corners, the corners; a color may follow.
  Result<void> read_faces(std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) {
      next_line();
      const auto size_word = next_word();
      const auto size = read_count(size_word);
      if (!size) return refuse("the number of a face's corners", size_word);
      faces_.begin();
      for (std::uint64_t corner = 0; corner < *size; ++corner) {
        const auto found = word();
        const auto value = parse_integer(found).value_or(-1);
        if (value < 0 || static_cast<std::uint64_t>(value) >= cloud_.points.size()) {
          return refuse(fmt::format("the index of a vertex below {}", cloud_.points.size()), found);
        }
        faces_.add(static_cast<std::uint32_t>(value));
      }
    }
    return {};
  }

  const Input& input_;
  TextCursor cursor_;
  bool in_comment_ = false;
  Cloud cloud_;
  Faces faces_;
};

}  // namespace

Result<Cloud> read_off(const Input& input) { return OffReader(input).read(); }

}  // namespace trivet::formats
