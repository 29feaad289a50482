#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numeric>
#include <string>
#include <tuple>
#include <vector>

#include "storage/common/stop.hpp"
#include "storage/files/scalar.hpp"
#include "storage/files/text.hpp"
#include "storage/formats/positions.hpp"
#include "storage/formats/readers.hpp"

namespace trivet::formats {
namespace {

constexpr std::size_t kPreambleBytes = 84, kFacetBytes = 50;

std::uint64_t announced_facets(const Input& input) {
  return load<std::uint32_t>(input.bytes.data() + 80, std::endian::little);
}

/// Whether the size matches the count of a binary file. The first bytes are no evidence: binary
/// files may begin with "solid" as well. As text, the four bytes would announce over 10 GB.
bool is_binary(const Input& input) {
  return input.bytes.size() >= kPreambleBytes &&
         input.bytes.size() == kPreambleBytes + kFacetBytes * announced_facets(input);
}

/// Whether it is not text: such a file is a binary one with a wrong size.
bool is_damaged_binary(const Input& input) {
  return input.bytes.size() >= kPreambleBytes &&
         input.text().substr(0, kPreambleBytes + kFacetBytes).find('\0') != std::string_view::npos;
}

Error refuse_size(const Input& input) {
  const std::uint64_t facets = announced_facets(input), size = input.bytes.size();
  const std::uint64_t announced = kPreambleBytes + kFacetBytes * facets;
  return input.refuse(
      fmt::format("expected the {} bytes of a binary STL file of {} triangles, as it announces, "
                  "found {} bytes, "
                  "enough for {}; the file is {}",
                  announced, facets, size, (size - kPreambleBytes) / kFacetBytes,
                  size < announced ? "truncated" : "damaged, or something else"));
}

/// Read corners, three per triangle.
Result<Positions> read_binary(const Input& input) {
  const std::size_t facets = (input.bytes.size() - kPreambleBytes) / kFacetBytes;
  if (3 * facets > input.max_points()) return input.refuse_count(3 * facets);
  Positions corners;
  corners.resize(3 * facets);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    // A facet has its normal, three corners and two spare bytes.
    const std::byte* const from =
        input.bytes.data() + kPreambleBytes + (i / 3) * kFacetBytes + 12 + (i % 3) * 12;
    corners.x[i] = load<float>(from, std::endian::little);
    corners.y[i] = load<float>(from + 4, std::endian::little);
    corners.z[i] = load<float>(from + 8, std::endian::little);
  }
  return corners;
}

/// Reads text; its words may be in capitals, its last line may be missing.
class TextReader {
 public:
  explicit TextReader(const Input& input) : input_(input), cursor_(input.text()) {}

  Result<Positions> read() {
    for (std::string_view word = cursor_.next_word(); !word.empty(); word = cursor_.next_word()) {
      TRIVET_TRY(read_element(word));
    }
    if (inside_facet_ || corners_.size() % 3 != 0)
      return refuse("\"endfacet\"; the file is truncated", "the end of the file");
    return std::move(corners_);
  }

 private:
  Error refuse(std::string_view expected, std::string_view found) const {
    return input_.refuse_line(cursor_.line(),
                              fmt::format("expected {}, found {}", expected, found));
  }

  Result<void> read_element(std::string_view word) {
    const std::string key = lower_case(word);
    if (!inside_solid_ && key != "solid")
      return refuse("an STL file: \"solid\", or a binary file of 84 + 50 bytes a facet",
                    quote(word));
    const bool bounds_solid = key == "solid" || key == "endsolid";
    if (inside_facet_ && (bounds_solid || key == "facet"))
      return refuse("\"endfacet\"", quote(word));
    if (bounds_solid) {
      inside_solid_ = key == "solid";
      skip(std::numeric_limits<std::size_t>::max());  // the name
    } else if (key == "facet") {
      inside_facet_ = true;
      corners_before_ = corners_.size();
    } else if (key == "endfacet") {
      inside_facet_ = false;
      if (corners_.size() != corners_before_ + 3) {
        return refuse("three vertices before the end of a facet",
                      fmt::format("{}", corners_.size() - corners_before_));
      }
    } else if (key == "vertex") {
      return read_corner();
    } else if (key == "normal" || key == "color") {
      skip(3);
    } else if (key != "outer" && key != "loop" && key != "endloop") {
      return refuse("a line of an STL file", quote(word));
    }
    return {};
  }

  void skip(std::size_t num_words) {
    while (num_words > 0 && !cursor_.word().empty()) --num_words;
  }

  Result<void> read_corner() {
    if (corners_.size() >= input_.max_points()) return input_.refuse_count(corners_.size() + 1);
    Eigen::Vector3d corner;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const auto word = cursor_.word();
      const auto number = parse_number(word);
      if (!number) return refuse("three numbers", quote_word(word));
      corner[i] = *number;
    }
    corners_.push_back(corner);
    return {};
  }

  const Input& input_;
  TextCursor cursor_;
  Positions corners_;
  std::size_t corners_before_ = 0;  // number of corners before the current facet
  bool inside_solid_ = false, inside_facet_ = false;
};

/// Merge corners at equal coordinates into one point, numbered by first appearance.
Cloud weld(PointsView corners) {
  // Compared as bits, since NaN has no order; zero and minus zero are the same position.
  const auto key = [&](std::uint32_t i) {
    const auto bits = [](float value) {
      return std::bit_cast<std::uint32_t>(value == 0 ? 0.0F : value);
    };
    return std::tuple(bits(corners.x[i]), bits(corners.y[i]), bits(corners.z[i]), i);
  };
  const auto same_place = [&](std::uint32_t i, std::uint32_t j) {
    const auto a = key(i), b = key(j);
    return std::get<0>(a) == std::get<0>(b) && std::get<1>(a) == std::get<1>(b) &&
           std::get<2>(a) == std::get<2>(b);
  };
  std::vector<std::uint32_t> order(corners.size());
  std::iota(order.begin(), order.end(), 0U);
  StopCheck check_stop(1 << 16);
  std::sort(order.begin(), order.end(), [&](auto i, auto j) {
    check_stop();
    return key(i) < key(j);
  });

  // The first corner at each position represents it; in corner order it precedes the others.
  std::vector<std::uint32_t> first(corners.size()), point(corners.size());
  for (std::size_t s = 0; s < order.size(); ++s) {
    const bool again = s > 0 && same_place(order[s - 1], order[s]);
    first[order[s]] = again ? first[order[s - 1]] : order[s];
  }
  Cloud cloud;
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    check_stop();
    if (first[i] == i) {
      point[i] = static_cast<std::uint32_t>(cloud.points.size());
      cloud.points.push_back(corners[i]);
    }
    point[i] = point[first[i]];
  }
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    cloud.triangles.push_back(point[i], point[i + 1], point[i + 2]);
  }
  return cloud;
}

}  // namespace

Result<Cloud> read_stl(const Input& input) {
  if (!is_binary(input) && is_damaged_binary(input)) return refuse_size(input);
  TRIVET_TRY_ASSIGN(auto corners, is_binary(input) ? read_binary(input) : TextReader(input).read());
  Cloud soup;
  place(std::move(corners), input, soup);
  Cloud cloud = weld(soup.points);
  cloud.offset = soup.offset;
  return cloud;
}

}  // namespace trivet::formats
