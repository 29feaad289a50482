#include <fmt/format.h>

#include <optional>
#include <utility>

#include "storage/files/text.hpp"
#include "storage/formats/faces.hpp"
#include "storage/formats/off_binary.hpp"
#include "storage/formats/off_header.hpp"
#include "storage/formats/positions.hpp"
#include "storage/formats/readers.hpp"

namespace trivet::formats {

namespace {

std::optional<OffKeyword> parse_keyword(std::string_view word) {
  OffKeyword keyword;
  const auto accept = [&](std::string_view prefix) {
    if (!word.starts_with(prefix)) return false;
    word.remove_prefix(prefix.size());
    return true;
  };
  keyword.has_texture = accept("ST");
  keyword.has_colors = accept("C");
  keyword.has_normals = accept("N");
  if (!accept("OFF")) return {};
  keyword.rest = word;
  return keyword;
}

/// Words of a text with comments from # to the end of the line.
class OffText {
 public:
  explicit OffText(std::string_view text) : cursor_(text) {}

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
  /// The next word of this line or a later one; empty at the end of the text.
  std::string_view next_word() {
    auto found = word();
    while (found.empty() && next_line()) found = word();
    return found;
  }
  /// Number of lines with words, from this one on.
  std::uint64_t count_lines() const {
    OffText lookahead = *this;
    std::uint64_t count = 0;
    do count += lookahead.word().empty() ? 0 : 1;
    while (lookahead.next_line());
    return count;
  }

  const TextCursor& cursor() const noexcept { return cursor_; }

 private:
  TextCursor cursor_;
  bool in_comment_ = false;
};

/// Formally, numbers may be anywhere, and a face's color extends to the end of its line. Most files
/// have one vertex or face per line, and colors of vertices that no keyword announces. So the
/// number of lines determines how a file is read.
enum class Layout {
  row_a_line,      ///< as many lines as rows: each row is on its own line
  rows_of_lines,   ///< more: a row may span several lines and ends with one
  rows_of_numbers  ///< fewer: a row ends after its last number
};

class OffReader {
 public:
  OffReader(const Input& input) : input_(input), text_(input.text()) {}

  Result<Cloud> read() {
    const auto first = text_.next_word();
    auto keyword = parse_keyword(first);
    if (!keyword && read_count(first)) keyword = OffKeyword{.rest = first};  // optional
    if (!keyword) {
      return refuse(
          "a file that begins with OFF, COFF, NOFF or STOFF, of vertices with three coordinates",
          first);
    }
    auto word = keyword->rest.empty() ? text_.next_word() : keyword->rest;
    if (word == "BINARY") {
      text_.next_line();
      return read_off_binary(input_, *keyword, text_.cursor().position());
    }

    std::uint64_t counts[3] = {};
    for (std::uint64_t& count : counts) {
      const auto value = read_count(word);
      if (!value) return refuse("the numbers of vertices, faces and edges", word);
      count = *value;
      if (&count != &counts[2]) word = text_.next_word();
    }
    const auto [vertices, faces, edges] = counts;
    TRIVET_TRY(check_counts(vertices, faces));
    const std::uint64_t lines = text_.count_lines();
    layout_ = lines == vertices + faces  ? Layout::row_a_line
              : lines > vertices + faces ? Layout::rows_of_lines
                                         : Layout::rows_of_numbers;

    TRIVET_TRY(read_vertices(vertices, *keyword));
    TRIVET_TRY(read_faces(faces));
    if (const auto more = text_.next_word(); !more.empty())
      return refuse("the end of the file behind the last face", more);
    place(std::move(positions_), input_, cloud_);
    cloud_.normals = round_to_floats(std::move(normals_));
    TRIVET_TRY(std::move(faces_).put_into(cloud_, input_));
    return std::move(cloud_);
  }

 private:
  Error refuse(std::string_view expected, std::string_view found) const {
    const bool ends_line = found.empty() && layout_ == Layout::row_a_line;
    return input_.refuse_line(
        text_.cursor().line(),
        fmt::format("expected {}, found {}", expected,
                    found.empty() && !ends_line ? "the end of the file" : quote_word(found)));
  }

  static std::optional<std::uint64_t> read_count(std::string_view word) {
    const auto count = parse_integer(word);
    return count && *count >= 0 ? std::optional(static_cast<std::uint64_t>(*count)) : std::nullopt;
  }

  Result<void> check_counts(std::uint64_t vertices, std::uint64_t faces) const {
    if (vertices > input_.max_points()) return input_.refuse_count(vertices);
    // A vertex takes at least three digits and blanks, a face one.
    const std::size_t remaining = text_.cursor().remaining();
    if (vertices <= remaining / 5 && faces <= remaining / 2) return {};
    return input_.refuse(
        fmt::format("expected {} vertices and {} faces, which do not fit into the {} "
                    "bytes that follow; the file is truncated",
                    vertices, faces, remaining));
  }

  /// The first word of a row, or a further one.
  std::string_view row_word(bool is_first) {
    return is_first || layout_ != Layout::row_a_line ? text_.next_word() : text_.word();
  }

  /// Skip the rest of a line after a row's numbers.
  Result<void> end_row(std::string_view what, std::uint64_t most_numbers) {
    if (layout_ == Layout::rows_of_numbers) return {};
    std::uint64_t count = 0;
    for (auto found = text_.word(); !found.empty(); found = text_.word()) {
      if (!parse_number(found) || ++count > most_numbers) return refuse(what, found);
    }
    return {};
  }

  Result<Eigen::Vector3d> read_vector(bool begins_row) {
    Eigen::Vector3d v;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const auto found = row_word(begins_row && i == 0);
      const auto number = parse_number(found);
      if (!number) return refuse("three numbers of a vertex", found);
      v[i] = *number;
    }
    return v;
  }

  Result<void> read_vertices(std::uint64_t count, const OffKeyword& keyword) {
    constexpr std::uint64_t kMostNumbers = 4 + 2;  // a color and texture coordinates
    for (std::uint64_t i = 0; i < count; ++i) {
      TRIVET_TRY_ASSIGN(const auto point, read_vector(true));
      positions_.push_back(point);
      if (keyword.has_normals) {
        TRIVET_TRY_ASSIGN(const auto normal, read_vector(false));
        normals_.push_back(normal);
      }
      if (layout_ == Layout::rows_of_numbers) {
        for (std::uint32_t k = 0; k < keyword.num_others(); ++k) {
          const auto found = text_.next_word();
          if (!parse_number(found)) return refuse("a number of a vertex's color or texture", found);
        }
      }
      auto ended =
          end_row("at most six numbers of color and texture behind a vertex", kMostNumbers);
      if (!ended) return ended;
    }
    return {};
  }

  /// Read the number of corners and the corners; a color may follow.
  Result<void> read_faces(std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto size_word = row_word(true);
      const auto size = read_count(size_word);
      if (!size) return refuse("the number of a face's corners", size_word);
      faces_.begin();
      for (std::uint64_t corner = 0; corner < *size; ++corner) {
        const auto found = row_word(false);
        const auto value = parse_integer(found).value_or(-1);
        if (value < 0 || static_cast<std::uint64_t>(value) >= positions_.size()) {
          return refuse(fmt::format("the index of a vertex below {}", positions_.size()), found);
        }
        faces_.add(static_cast<std::uint32_t>(value));
      }
      TRIVET_TRY(end_row("at most four numbers of a color behind a face", 4));
    }
    return {};
  }

  const Input& input_;
  OffText text_;
  Layout layout_ = Layout::rows_of_numbers;
  Positions positions_, normals_;
  Cloud cloud_;
  Faces faces_;
};

}  // namespace

Result<Cloud> read_off(const Input& input) { return OffReader(input).read(); }

}  // namespace trivet::formats
