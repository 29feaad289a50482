/// Machine parts made to order, so that demos, tests and studies need no data from elsewhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "storage/data/cloud.hpp"
#include "storage/data/mesh.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet {

struct Part {
  std::string name;     ///< family and number, as "bracket_3": a model's name, unique in a list
  Points vertices;      ///< [m]; 0.02 to 0.2 in diameter, of a household to 0.33
  Triangles triangles;  ///< one closed manifold, wound outward; some 2,000 to 10,000
  Symmetry symmetry;    ///< of the ideal part, about the origin; declared; trivial() for none
  bool metal = false;   ///< shiny: depth sensors lose its highlights
  Mesh hollow{};        ///< the same thing open and empty, in its place; empty: there is none
};

/// Names of the families of machine parts, in the order in which they take turns.
std::vector<std::string> part_families();
/// Names of the families of things of a household (cups, bottles, tools). They are made only where
/// they are named, one by one or all of them as kHousehold.
std::vector<std::string> household_families();
inline constexpr const char* kHousehold = "household";
/// Everything that may be named.
std::vector<std::string> known_families();

/// Parts that are made at once, at most.
inline constexpr std::uint32_t kMaxParts = 10'000;

/// The first n parts of a seed: the families take turns, each time with other sizes and
/// proportions.
///
/// families  only these take turns, in their order, each of them one of known_families(); empty:
///           all of part_families()
///
/// A part is the same whichever families take turns: bracket_3 is the fourth bracket of the seed.
/// Among the families are mirror pairs (clamp_left_3 and clamp_right_3 are the two hands of one
/// design) and a part that lacks a symmetry by one hole (drill_plate_3 beside plate_3).
/// Same for any number of threads; a longer list begins with the shorter one. Cost: some 0.1 s a
/// part on one core.
/// The mesh has its symmetry to within 0.5 % of the diameter.
std::vector<Part> make_parts(std::size_t n, std::uint64_t seed,
                             std::span<const std::string> families = {});

}  // namespace trivet
