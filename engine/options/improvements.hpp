/// Named parts of the recognition beyond voting and clustering. Each can be switched off to measure
/// its contribution: docs/study/ladder.toml goes from none of them to all of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>

#include "engine/options/option.hpp"

namespace trivet {

/// Parts of the pipeline beyond the published method. Each can be switched off to measure its
/// contribution.
enum class Improvement : std::uint8_t {
  clusters,
  planes,
  references,
  ball,
  full_cells,
  normals,
  refinement,
  visibility,
  contour,
  background,
  explained,
  rays,
  correlated_noise,
  second_round,
  alternatives,
};

/// In the order of the enumeration, which is also the order of the ladder.
inline constexpr std::array<Choice, 15> kImprovements{{
    {"clusters", "every cluster of votes may be an instance, not each model's strongest alone"},
    {"planes", "points on planes larger than every model do not vote"},
    {"references", "a tenth of the sampled points are reference points, not a fifth"},
    {"ball", "pairs end within 0.4 diameters, in the second round 0.7, not a whole one"},
    {"full-cells", "the fullest cells of a pair table, which distinguish least, do not vote"},
    {"normals", "normals are fitted to windows as wide as the scene's noise asks for"},
    {"refinement", "poses are refined by point-to-plane ICP"},
    {"visibility", "poses are scored by the surface that the sensor should see, not by votes"},
    {"contour",
     "a scene that runs on beyond the outline counts against a pose, before any ray is shot"},
    {"background", "planes larger than a model support no pose of it"},
    {"explained",
     "a detection must explain pixels that no better one does, not just lie apart from its like"},
    {"rays",
     "the last poses are tested ray by ray, and scored by their probability of being right"},
    {"correlated-noise",
     "errors that many pixels share are measured on the scene's planes, and count against no pose"},
    {"second-round", "a second round votes on what no sure detection explains"},
    {"alternatives",
     "a detection is held against its near-symmetric alternatives where their renderings differ"},
}};

/// A subset of the improvements.
class ImprovementSet {
 public:
  constexpr ImprovementSet() = default;
  constexpr ImprovementSet(std::initializer_list<Improvement> improvements) {
    for (const Improvement improvement : improvements) insert(improvement);
  }
  constexpr void insert(Improvement improvement) noexcept { bits_ |= bit(improvement); }
  constexpr bool contains(Improvement improvement) const noexcept {
    return (bits_ & bit(improvement)) != 0;
  }
  constexpr bool operator==(const ImprovementSet&) const = default;

 private:
  static constexpr std::uint32_t bit(Improvement improvement) noexcept {
    return std::uint32_t{1} << static_cast<std::uint32_t>(improvement);
  }
  std::uint32_t bits_ = 0;
};

}  // namespace trivet
