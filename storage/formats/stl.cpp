#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <tuple>
#include <vector>

#include "storage/files/scalar.hpp"
#include "storage/files/text.hpp"
#include "storage/formats/readers.hpp"

namespace trivet::formats {
namespace {

constexpr std::size_t kPreambleBytes = 84, kFacetBytes = 50;

/// Whether the size is the one that a binary file announces. How it begins says nothing: binary
/// files may begin with "solid" as well. As text, the four bytes would announce over 10 GB.
bool is_binary(const Input& input) {
  if (input.bytes.size() < kPreambleBytes) return false;
  const std::uint64_t facets = load<std::uint32_t>(input.bytes.data() + 80, std::endian::little);
  return input.bytes.size() == kPreambleBytes + kFacetBytes * facets;
}

/// Corners, three a triangle.
Result<Points> read_binary(const Input& input) {
  const std::size_t facets = (input.bytes.size() - kPreambleBytes) / kFacetBytes;
  if (3 * facets > input.max_points()) return input.refuse_count(3 * facets);
  Points corners(3 * facets);
  const PointsSpan out = corners.span();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    // A facet is its normal, three corners and two spare bytes.
    const std::byte* const from =
        input.bytes.data() + kPreambleBytes + (i / 3) * kFacetBytes + 12 + (i % 3) * 12;
    out.x[i] = load<float>(from, std::endian::little);
    out.y[i] = load<float>(from + 4, std::endian::little);
    out.z[i] = load<float>(from + 8, std::endian::little);
  }
  return corners;
}

Result<Points> read_text(const Input& input) {
  TextCursor cursor(input.text());
  const auto refuse = [&](std::string_view expected, std::string_view found) {
    return input.refuse_line(cursor.line(),
                             fmt::format("expected {}, found {}", expected, quote(found)));
  };

  Points corners;
  std::size_t corners_before = 0;  // the facet
  bool inside_solid = false;
  do {
    const auto key = cursor.word();
    if (key.empty()) continue;
    if (!inside_solid && key != "solid") {
      return refuse("an STL file: \"solid\", or a binary file of 84 + 50 bytes a facet", key);
    }
    if (key == "solid") {
      inside_solid = true;
    } else if (key == "endsolid") {
      inside_solid = false;
    } else if (key == "facet") {
      corners_before = corners.size();
    } else if (key == "endfacet") {
      if (corners.size() != corners_before + 3) {
        return refuse("three vertices before the end of a facet",
                      fmt::format("{}", corners.size() - corners_before));
      }
    } else if (key == "vertex") {
      if (corners.size() >= input.max_points()) return input.refuse_count(corners.size() + 1);
      Eigen::Vector3f corner;
      for (Eigen::Index i = 0; i < 3; ++i) {
        const auto word = cursor.word();
        const auto number = parse_number(word);
        if (!number) return refuse("three numbers", word);
        corner[i] = to_float(*number);
      }
      corners.push_back(corner);
    } else if (key != "outer" && key != "endloop") {
      return refuse("a line of an STL file", key);
    }
  } while (cursor.next_line());

  if (inside_solid || corners.size() % 3 != 0) {
    return refuse("\"endsolid\" at the end; the file is truncated", "the end of the file");
  }
  return corners;
}

/// Make corners at equal coordinates one point, numbered by first appearance.
Cloud weld(PointsView corners) {
  // Compared as bits, since not-a-number has no order; zero and minus zero are one place.
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
  std::sort(order.begin(), order.end(), [&](auto i, auto j) { return key(i) < key(j); });

  // The first corner at each place stands for it; in corner order it comes before the others.
  std::vector<std::uint32_t> first(corners.size()), point(corners.size());
  for (std::size_t s = 0; s < order.size(); ++s) {
    const bool again = s > 0 && same_place(order[s - 1], order[s]);
    first[order[s]] = again ? first[order[s - 1]] : order[s];
  }
  Cloud cloud;
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
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
  const auto corners = is_binary(input) ? read_binary(input) : read_text(input);
  if (!corners) return corners.error();
  return weld(*corners);
}

}  // namespace trivet::formats
