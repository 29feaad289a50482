/// Models with random content that satisfy the format, and their comparison bit for bit.
#pragma once

#include <cstdint>
#include <string>

#include "storage/data/model.hpp"

namespace trivet::test {

struct RandomModelSize {
  std::size_t num_vertices = 50, num_triangles = 80, num_samples = 40, num_ppf_points = 30,
              num_entries = 500, num_features = 20;
  std::uint32_t num_distance_bins = 6, num_angle_bins = 5;
};

/// A model of random content; the same name and seed give the same model.
Model random_model(const std::string& name, std::uint64_t seed, const RandomModelSize& size = {});

/// A basis of random content with this many components; the features of random_model have
/// kRandomComponents.
TriSpinBasis random_basis(std::uint64_t seed, std::size_t num_components);
inline constexpr std::size_t kRandomComponents = 7;

/// Empty if equal bit for bit, or the name of the first part that differs.
std::string difference(const Model& a, const Model& b);
std::string difference(const TriSpinBasis& a, const TriSpinBasis& b);

}  // namespace trivet::test
