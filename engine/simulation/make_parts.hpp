/// Generated machine parts, so that demos, tests and studies need no external data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "storage/data/cloud.hpp"
#include "storage/data/mesh.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet {

struct Part {
  std::string name;  ///< family and number, such as "bracket_3": a model's name, unique in a list
  Points vertices;   ///< [m]; diameter of 0.02 to 0.2, for household objects up to 0.33
  Triangles triangles;  ///< one closed manifold, oriented outward; about 2,000 to 10,000
  Symmetry symmetry;  ///< declared symmetry of the ideal part, about the origin; trivial() for none
  bool metal = false;  ///< shiny surface, whose highlights depth sensors cannot measure
  Mesh hollow{};       ///< the object opened and emptied, in the same place; empty: none
};

/// Names of the families of machine parts, in the order in which they take turns.
std::vector<std::string> part_families();
/// Names of groups of families: "household" (cups, bottles, tools), "sheets", "boxes", "fasteners".
/// Families that are not among part_families() are made only on request, by their name or a group's.
std::vector<std::string> family_groups();
/// Names of the families of a group; none for other names.
std::vector<std::string> families_of(std::string_view group);
/// All valid names of families and groups.
std::vector<std::string> known_families();

/// Maximum number of generated parts.
inline constexpr std::uint32_t kMaxParts = 10'000;

/// The first n parts of a seed. The families take turns, each time with other sizes and
/// proportions.
///
/// families  only these take turns, in their order, each one of known_families(); empty: all of
///           part_families()
///
/// A part is independent of the other families: bracket_3 is the fourth bracket of the seed. The
/// families include mirror pairs (clamp_left_3 and clamp_right_3 are mirror images of one design)
/// and a part whose symmetry is broken by one hole (drill_plate_3, compared with plate_3). The
/// result is the same for any number of threads; a longer list begins with the shorter one. Cost:
/// about 0.1 s per part on one core.
/// The mesh is symmetric to within 0.5 % of the diameter.
std::vector<Part> make_parts(std::size_t n, std::uint64_t seed,
                             std::span<const std::string> families = {});

}  // namespace trivet
