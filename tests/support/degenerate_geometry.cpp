#include "support/degenerate_geometry.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>

namespace trivet::test {
namespace {

constexpr std::array<std::array<std::uint32_t, 3>, 4> kSides{
    {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
constexpr std::array<std::array<float, 3>, 4> kCorners{
    {{-100, -100, 400}, {100, -100, 400}, {-100, 100, 400}, {-100, -100, 550}}};

/// Replaces test::Random, whose seed comes from the running test: a fuzzer runs none.
class Random {
 public:
  float uniform(float low, float high) {
    return low + (high - low) * std::uniform_real_distribution<float>(0, 1)(engine_);
  }

 private:
  std::mt19937 engine_{1};
};

/// Adds a triangle of every three consecutive vertices, from both sides.
void close(Cloud& cloud) {
  const auto n = static_cast<std::uint32_t>(cloud.points.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    cloud.triangles.push_back(i, (i + 1) % n, (i + 2) % n);
    cloud.triangles.push_back(i, (i + 2) % n, (i + 1) % n);
  }
}

}  // namespace

std::vector<DegenerateMesh> degenerate_meshes() {
  using Place = std::function<Eigen::Vector3f(Random&, std::size_t i)>;
  const auto any = [](Random& random) {
    return Eigen::Vector3f(random.uniform(-100, 100), random.uniform(-100, 100),
                           random.uniform(400, 600));
  };
  const std::vector<std::pair<std::string, Place>> kinds{
      {"one place", [](Random&, std::size_t) { return Eigen::Vector3f(1, 2, 3); }},
      {"the origin", [](Random&, std::size_t) { return Eigen::Vector3f(0, 0, 0); }},
      {"a line",
       [](Random& random, std::size_t) {
         return Eigen::Vector3f(Eigen::Vector3f(3, 5, 400) * random.uniform(0.5F, 1));
       }},
      {"a line of whole numbers",
       [](Random&, std::size_t i) { return Eigen::Vector3f(static_cast<float>(i), 0, 400); }},
      {"a plane",
       [&](Random& random, std::size_t) {
         Eigen::Vector3f p = any(random);
         p.z() = 400;
         return p;
       }},
      {"two places",
       [](Random&, std::size_t i) { return Eigen::Vector3f(i % 2 == 0 ? 0 : 200, 0, 400); }},
      {"scattered", [&](Random& random, std::size_t) { return any(random); }},
      {"far",
       [&](Random& random, std::size_t) {
         return Eigen::Vector3f(any(random) + Eigen::Vector3f::Constant(1e6F));
       }},
      {"small", [&](Random& random, std::size_t) { return Eigen::Vector3f(any(random) * 1e-7F); }},
      {"tiny", [&](Random& random, std::size_t) { return Eigen::Vector3f(any(random) * 1e-20F); }},
      {"denormal",
       [&](Random& random, std::size_t) { return Eigen::Vector3f(any(random) * 1e-41F); }},
      {"huge", [&](Random& random, std::size_t) { return Eigen::Vector3f(any(random) * 1e28F); }},
  };
  std::vector<DegenerateMesh> meshes;
  for (const auto& [name, place] : kinds) {
    Random random;
    for (std::size_t n = 1; n <= 12; ++n) {
      DegenerateMesh mesh{fmt::format("{}, {} vertices", name, n), {}};
      for (std::size_t i = 0; i < n; ++i) mesh.cloud.points.push_back(place(random, i));
      close(mesh.cloud);
      meshes.push_back(std::move(mesh));
    }
  }
  return meshes;
}

Cloud layered_tetrahedron(std::size_t layers) {
  Cloud cloud;
  for (const auto& [x, y, z] : kCorners) cloud.points.push_back({x, y, z});
  for (std::size_t k = 0; k < layers; ++k) {
    for (const auto& [a, b, c] : kSides) cloud.triangles.push_back(a, b, c);
  }
  return cloud;
}

Cloud shifted_tetrahedra(std::size_t layers) {
  Cloud cloud;
  for (std::size_t k = 0; k < layers; ++k) {
    const auto first = static_cast<std::uint32_t>(cloud.points.size());
    const float shift = 0.01F * static_cast<float>(k) / static_cast<float>(layers);
    for (const auto& [x, y, z] : kCorners) cloud.points.push_back({x + shift, y, z});
    for (const auto& [a, b, c] : kSides) cloud.triangles.push_back(first + a, first + b, first + c);
  }
  return cloud;
}

std::string obj_file(const Cloud& cloud) {
  std::string text;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3f p = cloud.points[i];
    text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
  }
  const Triangles& t = cloud.triangles;
  for (std::size_t k = 0; k < t.size(); ++k)
    text += fmt::format("f {} {} {}\n", t.a[k] + 1, t.b[k] + 1, t.c[k] + 1);
  return text;
}

}  // namespace trivet::test
