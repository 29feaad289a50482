#include "engine/simulation/make_parts.hpp"

#include <algorithm>
#include <cmath>

#include "engine/common/parallel.hpp"
#include "engine/simulation/parts/design.hpp"
#include "kernels/common/counter_random.hpp"
#include "kernels/meshing/decimate_mesh.hpp"
#include "kernels/simulation/mesh_solid.hpp"
#include "kernels/surfaces/diameter.hpp"
#include "storage/common/precondition.hpp"

namespace trivet {
namespace {

using engine::parts::Family;
using kernels::CounterRandom;

// Lattice cells per part, with edges relative to the bounds' diagonal. The smallest feature of the
// families, 2.5 % of the diagonal, is 2.5 cells wide.
constexpr float kNumCells = 250'000;
constexpr float kFinestCell = 1 / 160.0F, kCoarsestCell = 1 / 110.0F;
// Maximum error of decimation, relative to the diagonal, and its minimum number of triangles.
constexpr float kMaxError = 5e-4F;
constexpr std::size_t kNumTriangles = 2000;

Mesh mesh_part(const kernels::Solid& solid) {
  const Eigen::Vector3f sizes = solid.bounds().sizes();
  const float diagonal = sizes.norm();
  const float cell = std::clamp(std::cbrt(sizes.prod() / kNumCells), kFinestCell * diagonal,
                                kCoarsestCell * diagonal);
  const Mesh fine = kernels::mesh_solid(solid, cell);
  return kernels::decimate_mesh(fine.vertices, fine.triangles, kNumTriangles, kMaxError * diagonal);
}

/// number  index of the part within its family
Part make_part(const Family& family, std::size_t number, std::uint64_t seed) {
  CounterRandom random(seed, family.stream, number);
  const double ratio = static_cast<double>(family.largest_m / family.smallest_m);
  const auto diameter = family.smallest_m * static_cast<float>(std::pow(ratio, random.uniform()));
  engine::parts::Design design = family.draw(random);

  Mesh mesh = mesh_part(family.mirrored ? mirrored_x(design.solid) : design.solid);
  const float scale = diameter / kernels::find_diameter(mesh.vertices);
  Mesh hollow;
  if (design.hollow) hollow = mesh_part(*design.hollow);
  for (Points* vertices : {&mesh.vertices, &hollow.vertices}) {
    for (std::size_t i = 0; i < vertices->size(); ++i) vertices->set(i, scale * (*vertices)[i]);
  }
  return {std::string(family.name) + "_" + std::to_string(number),
          std::move(mesh.vertices),
          std::move(mesh.triangles),
          std::move(design.symmetry),
          family.metal,
          std::move(hollow)};
}

const Family& find_family(const std::string& name) {
  std::span<const Family> known = engine::parts::families();
  auto found = std::ranges::find(known, name, &Family::name);
  if (found == known.end()) {
    known = engine::parts::other_families();
    found = std::ranges::find(known, name, &Family::name);
  }
  TRIVET_REQUIRE(found != known.end(), "a family of known_families()");
  return *found;
}

/// Expand groups to single families.
std::vector<std::string> single_families(std::span<const std::string> families) {
  if (families.empty()) return part_families();
  std::vector<std::string> single;
  for (const std::string& name : families) {
    const std::vector<std::string> group = families_of(name);
    if (group.empty()) {
      single.push_back(name);
    } else {
      single.insert(single.end(), group.begin(), group.end());
    }
  }
  return single;
}

}  // namespace

std::vector<std::string> part_families() {
  std::vector<std::string> names;
  for (const Family& family : engine::parts::families()) names.emplace_back(family.name);
  return names;
}

std::vector<std::string> family_groups() {
  std::vector<std::string> names;
  for (const auto& group : engine::parts::groups()) names.emplace_back(group.name);
  return names;
}

std::vector<std::string> families_of(std::string_view group) {
  for (const auto& known : engine::parts::groups()) {
    if (known.name == group) return {known.families.begin(), known.families.end()};
  }
  return {};
}

std::vector<std::string> known_families() {
  std::vector<std::string> names = part_families();
  for (const Family& family : engine::parts::other_families()) names.emplace_back(family.name);
  for (std::string& group : family_groups()) names.push_back(std::move(group));
  return names;
}

std::vector<Part> make_parts(std::size_t n, std::uint64_t seed,
                             std::span<const std::string> asked) {
  const std::vector<std::string> single = single_families(asked);
  const std::span<const std::string> families = single;
  std::vector<Part> parts(n);
  engine::for_each_index(n, [&](std::size_t i) {
    const std::string& name = families[i % families.size()];
    // A family that is named twice has two turns.
    const auto turns = [&](std::span<const std::string> names) {
      return static_cast<std::size_t>(std::ranges::count(names, name));
    };
    const std::size_t number =
        i / families.size() * turns(families) + turns(families.first(i % families.size()));
    parts[i] = make_part(find_family(name), number, seed);
  });
  return parts;
}

}  // namespace trivet
