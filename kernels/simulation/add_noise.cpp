#include "kernels/simulation/add_noise.hpp"

#include "kernels/common/counter_random.hpp"
#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

// Streams of random numbers, distinct from each other and from that of drop_points.cpp.
constexpr std::uint64_t kGaussian = 0x6A75, kRay = 0x7261, kShot = 0x7368;

}  // namespace

void add_gaussian_noise(PointsView points, float sigma, std::uint64_t seed, std::size_t first,
                        PointsSpan out) {
  TRIVET_REQUIRE(out.size() == points.size(), "one result a point");
  for (std::size_t i = 0; i < points.size(); ++i) {
    CounterRandom random(seed, kGaussian, first + i);
    const auto disturbed = [&](float value) {
      return static_cast<float>(value + static_cast<double>(sigma) * random.normal());
    };
    const float x = disturbed(points.x[i]), y = disturbed(points.y[i]), z = disturbed(points.z[i]);
    out.set(i, {x, y, z});
  }
}

void add_ray_noise(PointsView points, const Eigen::Vector3f& viewpoint, float sigma,
                   std::uint64_t seed, std::size_t first, PointsSpan out) {
  TRIVET_REQUIRE(out.size() == points.size(), "one result a point");
  for (std::size_t i = 0; i < points.size(); ++i) {
    CounterRandom random(seed, kRay, first + i);
    const Eigen::Vector3d point = points[i].cast<double>();
    const Eigen::Vector3d ray = point - viewpoint.cast<double>();
    const double distance = ray.norm();
    const double change = static_cast<double>(sigma) * random.normal();
    out.set(i, distance > 0 ? (point + change / distance * ray).cast<float>().eval() : points[i]);
  }
}

void add_shot_noise(PointsView points, const Eigen::AlignedBox3f& box, double share,
                    std::uint64_t seed, std::size_t first, PointsSpan out) {
  TRIVET_REQUIRE(out.size() == points.size(), "one result a point");
  for (std::size_t i = 0; i < points.size(); ++i) {
    CounterRandom random(seed, kShot, first + i);
    const bool moves = random.uniform() < share;
    const auto between = [&](float from, float to) {
      return static_cast<float>(random.uniform(from, to));
    };
    const float x = between(box.min().x(), box.max().x());
    const float y = between(box.min().y(), box.max().y());
    const float z = between(box.min().z(), box.max().z());
    out.set(i, moves ? Eigen::Vector3f(x, y, z) : points[i]);
  }
}

}  // namespace trivet::kernels
