#include "engine/simulation/make_parts.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <set>
#include <span>
#include <vector>

#include "engine/common/thread_limit.hpp"
#include "engine/simulation/parts/design.hpp"
#include "kernels/surfaces/sample_mesh.hpp"
#include "kernels/surfaces/visibility.hpp"
#include "kernels/symmetry/find_symmetry.hpp"
#include "support/reference_mesh.hpp"
#include "support/shapes.hpp"

namespace trivet {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kNumParts = 48;  // two of each family
constexpr std::uint64_t kSeed = 11;

const std::vector<Part>& many_parts() {
  static const std::vector<Part> all = make_parts(72, kSeed);
  return all;
}
std::span<const Part> parts() { return std::span(many_parts()).first(kNumParts); }

const engine::parts::Family& family(std::size_t i) {
  const auto all = engine::parts::families();
  return all[i % all.size()];
}

Mesh mesh_of(const Part& part) { return {part.vertices, part.triangles}; }

bool same_column(const auto& a, const auto& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}
bool same(const Part& a, const Part& b) {
  const PointsView p = a.vertices, q = b.vertices;
  return a.name == b.name && same_column(p.x, q.x) && same_column(p.y, q.y) &&
         same_column(p.z, q.z) && a.triangles.a == b.triangles.a &&
         a.triangles.b == b.triangles.b && a.triangles.c == b.triangles.c && a.metal == b.metal;
}

/// The declared symmetry motions, and some rotations about a declared axis.
std::vector<Pose> motions(const Symmetry& symmetry) {
  std::vector<Pose> out = symmetry.poses;
  if (symmetry.axis) {
    for (const float angle : {0.3F, 1.1F, 2.0F})
      out.emplace_back(Eigen::AngleAxisf(angle, symmetry.axis->direction).toRotationMatrix());
  }
  return out;
}

TEST(MakeParts, EveryPartIsOneClosedManifoldWoundOutward) {
  for (const Part& part : parts()) {
    SCOPED_TRACE(part.name);
    const Mesh mesh = mesh_of(part);
    EXPECT_TRUE(reference::is_closed_manifold(mesh));
    EXPECT_EQ(reference::num_pieces(mesh), 1U);
    EXPECT_GT(reference::volume(mesh), 0);
    EXPECT_GE(mesh.triangles.size(), 1900U);
    EXPECT_LE(mesh.triangles.size(), 12'000U);
  }
}

TEST(MakeParts, HolesAreThroughAndNoneIsExtra) {
  for (std::size_t i = 0; i < kNumParts; ++i) {
    kernels::CounterRandom random(kSeed, family(i).stream, i / engine::parts::families().size());
    random.uniform();  // skips the draw of the diameter
    const auto design = family(i).draw(random);
    EXPECT_EQ(reference::euler_characteristic(mesh_of(parts()[i])),
              2 - 2 * static_cast<int>(design.num_tunnels))
        << parts()[i].name;
  }
}

TEST(MakeParts, TheDeclaredMotionsMapThePartOntoItself) {
  for (const Part& part : parts()) {
    SCOPED_TRACE(part.name);
    EXPECT_TRUE(part.symmetry.declared);
    const Mesh mesh = mesh_of(part);
    const double diameter = reference::diameter(part.vertices);
    for (const Pose& motion : motions(part.symmetry)) {
      double worst = 0;
      for (std::size_t i = 0; i < part.vertices.size(); i += part.vertices.size() / 50) {
        const Vector3d p = motion.cast<double>() * part.vertices[i].cast<double>();
        worst = std::max(worst, reference::distance_to_mesh(p, mesh));
      }
      EXPECT_LT(worst, 0.005 * diameter);
    }
  }
}

/// The symmetry that training finds.
Symmetry found_symmetry(const Part& part, float diameter) {
  constexpr std::size_t kNumSamples = 3000;
  std::vector<double> sums(part.triangles.size());
  kernels::sum_areas(part.vertices, part.triangles, sums);
  Points points(kNumSamples);
  Normals normals(kNumSamples);
  kernels::sample_mesh({part.vertices, part.triangles, sums}, 1, 0, kNumSamples, {points, normals});
  const kernels::SampledSurface surface(points, normals, diameter);
  return kernels::find_symmetry(surface, kernels::TurnScreen(surface));
}

// Checks that no symmetry is missing. Teeth are small relative to the sample spacing: for gears,
// which have the most motions, some are not found.
TEST(MakeParts, NoSymmetryIsFoundThatIsNotDeclared) {
  std::size_t num_missed = 0;
  for (std::size_t i = 0; i < kNumParts; ++i) {
    const Part& part = parts()[i];
    const Symmetry found =
        found_symmetry(part, static_cast<float>(reference::diameter(part.vertices)));
    const bool axis = part.symmetry.axis.has_value();
    EXPECT_EQ(found.axis.has_value(), axis) << part.name;
    EXPECT_LE(found.poses.size(), part.symmetry.poses.size()) << part.name;
    num_missed += found.poses.size() < part.symmetry.poses.size();
  }
  EXPECT_LE(num_missed, 2U);
}

TEST(MakeParts, NoTwoOfAFamilyAreAlike) {
  std::map<std::string_view, std::vector<std::pair<double, double>>> families;
  const std::vector<Part>& many = many_parts();
  for (std::size_t i = 0; i < many.size(); ++i) {
    const double diameter = reference::diameter(many[i].vertices);
    EXPECT_GE(diameter, 0.0199);
    EXPECT_LE(diameter, 0.2001);
    const double fullness = reference::volume(mesh_of(many[i])) / (diameter * diameter * diameter);
    for (const auto& [other_diameter, other_fullness] : families[family(i).name]) {
      EXPECT_TRUE(std::abs(diameter / other_diameter - 1) > 0.002 ||
                  std::abs(fullness / other_fullness - 1) > 0.002)
          << many[i].name;
    }
    families[family(i).name].emplace_back(diameter, fullness);
  }
}

TEST(MakeParts, MirrorPairsAreMirrorImagesAndNotTheSamePart) {
  std::size_t num_pairs = 0;
  for (std::size_t i = 1; i < 48; ++i) {
    if (!family(i).mirrored) continue;
    ++num_pairs;
    const Mesh left = mesh_of(parts()[i - 1]), right = mesh_of(parts()[i]);
    const double diameter = reference::diameter(left.vertices);
    EXPECT_NEAR(reference::diameter(right.vertices), diameter, 1e-3 * diameter);
    double as_mirrored = 0, as_given = 0;
    for (std::size_t v = 0; v < left.vertices.size(); v += 5) {
      const Vector3d p = left.vertices[v].cast<double>();
      as_mirrored =
          std::max(as_mirrored, reference::distance_to_mesh({-p.x(), p.y(), p.z()}, right));
      as_given = std::max(as_given, reference::distance_to_mesh(p, right));
    }
    EXPECT_LT(as_mirrored, 0.005 * diameter);
    EXPECT_GT(as_given, 0.05 * diameter);
  }
  EXPECT_EQ(num_pairs, 4U);
}

TEST(MakeParts, ADrillPlateIsItsPlateWithOneHoleMoved) {
  for (std::size_t i = 1; i < kNumParts; ++i) {
    if (family(i).name != "drill_plate") continue;
    const Mesh even = mesh_of(parts()[i - 1]), odd = mesh_of(parts()[i]);
    EXPECT_NEAR(reference::volume(odd), reference::volume(even), 2e-3 * reference::volume(even));
    EXPECT_TRUE(parts()[i].symmetry.trivial());
    EXPECT_EQ(parts()[i - 1].symmetry.poses.size(), 3U);
  }
}

TEST(MakeParts, NamesAreUniqueNamesOfModels) {
  std::set<std::string> names;
  for (const Part& part : parts()) {
    EXPECT_TRUE(names.insert(part.name).second) << part.name;
    EXPECT_TRUE(std::isalnum(static_cast<unsigned char>(part.name[0])));
    EXPECT_EQ(part.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"),
              std::string::npos);
  }
}

TEST(MakeParts, ALongerListBeginsWithTheShorterOne) {
  const std::vector<Part> few = make_parts(10, kSeed);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_TRUE(same(few[i], parts()[i])) << i;
  EXPECT_TRUE(make_parts(0, kSeed).empty());
  EXPECT_FALSE(same(make_parts(1, kSeed + 1)[0], few[0]));
}

// 24 families: hex_nut is the second, washer the twelfth.
TEST(MakeParts, MakesPartsOfTheFamiliesThatAreAskedForWhichAreTheSameAsAmongAll) {
  const std::vector<Part> few = make_parts(4, kSeed, std::vector<std::string>{"washer", "hex_nut"});
  ASSERT_EQ(few.size(), 4U);
  const std::vector<std::size_t> places{11, 1, 35, 25};
  for (std::size_t i = 0; i < few.size(); ++i)
    EXPECT_TRUE(same(few[i], parts()[places[i]])) << few[i].name;
}

TEST(MakeParts, GivesAFamilyThatIsNamedTwiceTwoTurns) {
  const std::vector<Part> few =
      make_parts(6, kSeed, std::vector<std::string>{"hex_nut", "hex_nut", "washer"});
  std::vector<std::string> names;
  for (const Part& part : few) names.push_back(part.name);
  EXPECT_EQ(names, (std::vector<std::string>{"hex_nut_0", "hex_nut_1", "washer_0", "hex_nut_2",
                                             "hex_nut_3", "washer_1"}));
}

TEST(MakeParts, AllFamiliesTakeTurnsInTheOrderOfTheirNames) {
  const std::vector<std::string> families = part_families();
  EXPECT_EQ(families.size(), engine::parts::families().size());
  for (std::size_t i = 0; i < kNumParts; ++i) {
    EXPECT_EQ(parts()[i].name,
              families[i % families.size()] + "_" + std::to_string(i / families.size()));
  }
}

TEST(MakeParts, GivesTheSameBytesOnOneThread) {
  const std::span<const Part> parallel = parts();
  const ThreadLimit limit(1);
  const std::vector<Part> serial = make_parts(24, kSeed);
  for (std::size_t i = 0; i < serial.size(); ++i) EXPECT_TRUE(same(serial[i], parallel[i])) << i;
}

/// Two parts of each family that is made only on request.
const std::vector<Part>& requested() {
  static const std::vector<Part> all = [] {
    std::vector<std::string> names;
    for (const engine::parts::Family& family : engine::parts::other_families())
      names.emplace_back(family.name);
    return make_parts(2 * names.size(), kSeed, names);
  }();
  return all;
}

TEST(MakeParts, RequestedFamiliesAreClosedAndHaveTheHolesThatTheyDeclare) {
  const auto families = engine::parts::other_families();
  for (std::size_t i = 0; i < requested().size(); ++i) {
    const Part& part = requested()[i];
    SCOPED_TRACE(part.name);
    const engine::parts::Family& own = families[i % families.size()];
    EXPECT_EQ(part.name, std::string(own.name) + "_" + std::to_string(i / families.size()));
    kernels::CounterRandom random(kSeed, own.stream, i / families.size());
    random.uniform();  // skips the draw of the diameter
    const auto design = own.draw(random);
    EXPECT_EQ(design.hollow.has_value(), !part.hollow.triangles.empty());
    for (const Mesh& mesh : {mesh_of(part), part.hollow}) {
      if (mesh.triangles.empty()) continue;
      EXPECT_TRUE(reference::is_closed_manifold(mesh));
      EXPECT_EQ(reference::num_pieces(mesh), 1U);
      EXPECT_EQ(reference::euler_characteristic(mesh),
                2 - 2 * static_cast<int>(design.num_tunnels));
    }
    if (design.hollow) {
      EXPECT_LT(reference::volume(part.hollow), 0.7 * reference::volume(mesh_of(part)));
      EXPECT_LT(reference::diameter(part.hollow.vertices),
                1.001 * reference::diameter(part.vertices));
    }
  }
}

TEST(MakeParts, RequestedFamiliesHaveTheSymmetryThatTheyDeclareAndNoOther) {
  for (const Part& part : requested()) {
    SCOPED_TRACE(part.name);
    const double diameter = reference::diameter(part.vertices);
    for (const Mesh& mesh : {mesh_of(part), part.hollow}) {
      for (const Pose& motion : motions(part.symmetry)) {
        double worst = 0;
        for (std::size_t i = 0; i < mesh.vertices.size(); i += mesh.vertices.size() / 50) {
          const Vector3d p = motion.cast<double>() * mesh.vertices[i].cast<double>();
          worst = std::max(worst, reference::distance_to_mesh(p, mesh));
        }
        EXPECT_LT(worst, 0.005 * diameter);
      }
    }
    const Symmetry found = found_symmetry(part, static_cast<float>(diameter));
    EXPECT_EQ(found.axis.has_value(), part.symmetry.axis.has_value());
    EXPECT_LE(found.poses.size(), part.symmetry.poses.size());
  }
}

TEST(MakeParts, MakesOtherFamiliesOnlyWhereTheyOrTheirGroupIsNamed) {
  const std::vector<std::string> parts = part_families();
  for (const engine::parts::Family& family : engine::parts::other_families())
    EXPECT_EQ(std::ranges::find(parts, family.name), parts.end()) << family.name;
  const std::vector<Part> few = make_parts(2, kSeed, std::vector<std::string>{"hex_nut", "carton"});
  EXPECT_EQ(few[0].name, "hex_nut_0");
  EXPECT_TRUE(same(few[1], requested()[1]));

  const std::vector<Part> sheets = make_parts(4, kSeed, std::vector<std::string>{"sheets"});
  EXPECT_EQ(sheets[0].name, "sheet_0");
  EXPECT_EQ(sheets[2].name, "sheet_channel_0");
  EXPECT_EQ(sheets[3].name, "sheet_1");
}

TEST(MakeParts, GroupsHaveKnownFamilies) {
  const std::vector<std::string> known = known_families();
  for (const std::string& group : family_groups()) {
    EXPECT_FALSE(families_of(group).empty()) << group;
    for (const std::string& name : families_of(group))
      EXPECT_NE(std::ranges::find(known, name), known.end()) << name;
  }
  EXPECT_TRUE(families_of("hex_nut").empty());
}

/// The thickness of a flat part.
float thickness(const Part& part) {
  const std::span<const float> z = part.vertices.view().z;
  return *std::ranges::max_element(z) - *std::ranges::min_element(z);
}

TEST(MakeParts, SheetsAreAsThinAsSheetMetal) {
  for (const Part& part : make_parts(6, kSeed, std::vector<std::string>{"sheet"})) {
    EXPECT_GT(thickness(part), 0.0014F) << part.name;
    EXPECT_LT(thickness(part), 0.0075F) << part.name;
  }
}

}  // namespace
}  // namespace trivet
