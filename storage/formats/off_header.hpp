/// What an OFF file says of its vertices.
#pragma once

#include <cstdint>
#include <string_view>

namespace trivet::formats {

/// Geomview's keyword [ST][C][N]OFF says what each vertex has behind its place, in the order normal,
/// color, texture coordinates. 4OFF and nOFF have other than three dimensions and are not read.
struct OffKeyword {
  bool has_normals = false, has_colors = false, has_texture = false;
  std::string_view rest;  ///< a number glued to the keyword, as ModelNet's files have it

  /// Numbers of a vertex behind its place and normal; a color is one of four numbers.
  std::uint32_t num_others() const noexcept { return (has_colors ? 4 : 0) + (has_texture ? 2 : 0); }
};

}  // namespace trivet::formats
