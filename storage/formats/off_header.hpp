/// Vertex layout of an OFF file.
#pragma once

#include <cstdint>
#include <string_view>

namespace trivet::formats {

/// Geomview's keyword [ST][C][N]OFF lists the vertex attributes after the position, in the order
/// normal, color, texture coordinates. 4OFF and nOFF do not have three dimensions and are not read.
struct OffKeyword {
  bool has_normals = false, has_colors = false, has_texture = false;
  std::string_view rest;  ///< number joined to the keyword, as in ModelNet's files

  /// Count of numbers after a vertex's position and normal; a color has four.
  std::uint32_t num_others() const noexcept { return (has_colors ? 4 : 0) + (has_texture ? 2 : 0); }
};

}  // namespace trivet::formats
