#include "support/random_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

namespace trivet::test {
namespace {

using Random = std::mt19937_64;

float uniform(Random& random, float low, float high) {
  return std::uniform_real_distribution<float>(low, high)(random);
}

Eigen::Vector3f vector(Random& random) {
  return {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
}

Eigen::Vector3f unit_vector(Random& random) {
  Eigen::Vector3f v = vector(random);
  while (v.norm() < 0.1F) v = vector(random);
  return v.normalized();
}

Pose motion(Random& random) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisf(uniform(random, 0, 3), unit_vector(random)).toRotationMatrix();
  pose.translation() = vector(random);
  return pose;
}

Points points(Random& random, std::size_t n, Eigen::Vector3f (*draw)(Random&)) {
  Points out(n);
  for (std::size_t i = 0; i < n; ++i) out.set(i, draw(random));
  return out;
}

struct Table {
  Column<std::uint32_t> offsets;
  Column<PpfEntry> entries;
};

// Draws entries with their cell, sorts them as the format requires, then counts them.
void fill_table(Random& random, const RandomModelSize& size, Model& model) {
  model.ppf.quantization = {uniform(random, 0.01F, 0.1F), size.num_distance_bins,
                            size.num_angle_bins};
  model.ppf.num_references = static_cast<std::uint32_t>(size.num_ppf_points);
  const std::uint32_t num_cells = model.ppf.quantization.num_cells();
  struct Row {
    std::uint32_t cell;
    PpfEntry entry;
  };
  std::vector<Row> rows(size.num_entries);
  for (Row& row : rows) {
    row.cell = static_cast<std::uint32_t>(random() % num_cells);
    row.entry = {static_cast<std::uint16_t>(random() % size.num_ppf_points),
                 static_cast<std::uint16_t>(random())};
  }
  std::ranges::sort(rows, {}, [](const Row& row) {
    return std::uint64_t{row.cell} << 32 | std::uint64_t{row.entry.reference} << 16 |
           row.entry.angle;
  });

  auto table = std::make_shared<Table>();
  table->offsets.assign(num_cells + 1, 0);
  for (const Row& row : rows) {
    ++table->offsets[row.cell + 1];
    table->entries.push_back(row.entry);
  }
  for (std::size_t cell = 0; cell < num_cells; ++cell)
    table->offsets[cell + 1] += table->offsets[cell];
  PpfTableView view = model.ppf;
  view.offsets = table->offsets;
  view.entries = table->entries;
  model.ppf = {view, table};
}

TriSpinFeatures random_features(Random& random, std::size_t n) {
  TriSpinFeatures features;
  features.resolution = uniform(random, 0.001F, 0.1F);
  features.num_components = kRandomComponents;
  features.keypoints = points(random, n, vector);
  Column<FrameRows> frames;
  Column<std::uint8_t> codes;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> turn = motion(random).linear();
    std::ranges::copy(std::span(turn.data(), 9), frames.emplace_back().begin());
    for (std::size_t k = 0; k < kRandomComponents; ++k)
      codes.push_back(static_cast<std::uint8_t>(random()));
  }
  features.frames = std::move(frames);
  features.codes = std::move(codes);
  return features;
}

template <class T>
bool same(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}
bool same(PointsView a, PointsView b) { return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z); }
template <class T, class Allocator>
bool same(const std::vector<T, Allocator>& a, const std::vector<T, Allocator>& b) {
  return same<T>(std::span<const T>(a), std::span<const T>(b));
}

bool same(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  const auto same_pose = [](const Pose& p, const Pose& q) { return p.matrix() == q.matrix(); };
  return std::ranges::equal(a, b, same_pose);
}

bool same(const std::optional<Symmetry::Axis>& a, const std::optional<Symmetry::Axis>& b) {
  return a.has_value() == b.has_value() &&
         (!a || (a->direction == b->direction && a->point == b->point));
}
bool same(const Symmetry& a, const Symmetry& b) {
  return a.declared == b.declared && same(a.poses, b.poses) && same(a.axis, b.axis);
}

bool same(const TriSpinFeatures& a, const TriSpinFeatures& b) {
  return a.resolution == b.resolution && same(a.keypoints, b.keypoints) &&
         same<FrameRows>(a.frames, b.frames) && same<std::uint8_t>(a.codes, b.codes);
}

}  // namespace

Model random_model(const std::string& name, std::uint64_t seed, const RandomModelSize& size) {
  Random random(seed);
  Model model;
  model.name = name;
  model.source = name + ".ply";
  model.source_xxh3 = "0123456789abcdef0123456789abcdef";
  model.fingerprint = seed % 3 == 0 ? "" : "fedcba9876543210fedcba9876543210";
  model.diameter = uniform(random, 0.1F, 3);
  model.center = vector(random);
  model.sample_spacing = uniform(random, 0.001F, 0.1F);
  for (int i = 0; i < 3; ++i) model.symmetry.poses.push_back(motion(random));
  model.symmetry.axis = Symmetry::Axis{unit_vector(random), vector(random)};
  model.symmetry.declared = seed % 2 == 0;
  for (int i = 0; i < 2; ++i) model.near_symmetries.push_back(motion(random));
  model.near_axis = Symmetry::Axis{unit_vector(random), vector(random)};

  model.vertices = points(random, size.num_vertices, vector);
  const auto corner = [&] { return static_cast<std::uint32_t>(random() % size.num_vertices); };
  Triangles triangles;
  for (std::size_t i = 0; i < size.num_triangles; ++i)
    triangles.push_back(corner(), corner(), corner());
  model.triangles = std::move(triangles);
  model.samples = points(random, size.num_samples, vector);
  model.sample_normals = points(random, size.num_samples, unit_vector);
  Column<ViewMask> views;
  for (std::size_t i = 0; i < size.num_samples; ++i)
    views.push_back({random(), random(), random(), random()});
  model.sample_views = std::move(views);
  model.ppf_points = points(random, size.num_ppf_points, vector);
  model.ppf_normals = points(random, size.num_ppf_points, unit_vector);
  fill_table(random, size, model);
  for (TriSpinFeatures& features : model.features)
    features = random_features(random, size.num_features);
  return model;
}

TriSpinBasis random_basis(std::uint64_t seed, std::size_t num_components) {
  Random random(seed);
  TriSpinBasis basis;
  basis.support = uniform(random, 1, 30);
  basis.code_step = uniform(random, 0.001F, 0.1F);
  PcaBasis& pca = basis.components;
  pca.dimension = 675;
  pca.all_energy = uniform(random, 0.1F, 1);
  const auto fill = [&](std::size_t n, Column<float>& out) {
    for (std::size_t i = 0; i < n; ++i) out.push_back(uniform(random, -1, 1));
  };
  fill(pca.dimension, pca.mean);
  fill(pca.dimension * num_components, pca.components);
  fill(num_components, pca.energies);
  return basis;
}

std::string difference(const Model& a, const Model& b) {
  if (a.name != b.name) return "name";
  if (a.source != b.source || a.source_xxh3 != b.source_xxh3) return "source";
  if (a.fingerprint != b.fingerprint) return "fingerprint";
  if (a.diameter != b.diameter || a.center != b.center || a.sample_spacing != b.sample_spacing)
    return "scalars";
  if (!same(a.symmetry, b.symmetry)) return "symmetry";
  if (!same(a.near_symmetries, b.near_symmetries)) return "near_symmetries";
  if (!same(a.near_axis, b.near_axis)) return "near_axis";
  if (!same(a.vertices, b.vertices)) return "vertices";
  if (!same(a.triangles.a, b.triangles.a) || !same(a.triangles.b, b.triangles.b) ||
      !same(a.triangles.c, b.triangles.c))
    return "triangles";
  if (!same(a.samples, b.samples)) return "samples";
  if (!same(a.sample_normals, b.sample_normals)) return "sample_normals";
  if (!same(a.sample_views, b.sample_views)) return "sample_views";
  if (!same(a.ppf_points, b.ppf_points)) return "ppf/points";
  if (!same(a.ppf_normals, b.ppf_normals)) return "ppf/normals";
  if (!(a.ppf.quantization == b.ppf.quantization)) return "ppf quantization";
  if (!same(a.ppf.offsets, b.ppf.offsets)) return "ppf/offsets";
  if (!same(a.ppf.entries, b.ppf.entries)) return "ppf/entries";
  for (std::size_t k = 0; k < a.features.size(); ++k) {
    if (!same(a.features[k], b.features[k])) return "features";
  }
  return {};
}

std::string difference(const TriSpinBasis& a, const TriSpinBasis& b) {
  if (a.support != b.support || a.code_step != b.code_step) return "scalars";
  if (a.components.all_energy != b.components.all_energy ||
      a.components.dimension != b.components.dimension)
    return "sizes";
  if (!same(a.components.mean, b.components.mean)) return "mean";
  if (!same(a.components.components, b.components.components)) return "components";
  if (!same(a.components.energies, b.components.energies)) return "energies";
  return {};
}

}  // namespace trivet::test
