/// Models with random content that obey the format, and their comparison bit for bit.
#pragma once

#include <cstdint>
#include <string>

#include "storage/model.hpp"

namespace trivet::test {

struct RandomModelSize {
  std::size_t num_vertices = 50, num_triangles = 80, num_samples = 40, num_ppf_points = 30,
              num_entries = 500;
  std::uint32_t num_distance_bins = 6, num_angle_bins = 5;
};

/// A model of random content; the same name and seed give the same model.
Model random_model(const std::string& name, std::uint64_t seed, const RandomModelSize& size = {});

/// Empty when equal bit for bit, or the name of the first part that differs.
std::string difference(const Model& a, const Model& b);

}  // namespace trivet::test
