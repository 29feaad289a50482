// Invariants of a model that recognition uses without further checks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "storage/common/counted.hpp"
#include "storage/common/simd.hpp"
#include "storage/files/file.hpp"
#include "storage/library/library_format.hpp"
#include "storage/library/model_name.hpp"

namespace trivet::format {
namespace {

constexpr float kUnitTolerance = 1e-3F;  // tolerance of the squared length; float rounding stays
                                         // below 1e-6

// Cubes of lengths between these are floats, in any unit of a length.
constexpr float kSmallest = 1e-12F, kLargest = 1e12F;
constexpr float kMostSupport = 1000;  // radius of descriptions [spacing of points]

bool is_length(float length) noexcept { return length >= kSmallest && length <= kLargest; }
bool is_point(const Eigen::Vector3f& v) noexcept {
  return (v.array().abs() <= kLargest).all();  // false for NaN
}
bool unit(const Eigen::Vector3f& v) noexcept {
  return std::abs(v.squaredNorm() - 1) <= kUnitTolerance;
}

/// Each check returns an empty text, or the fault and its position.
std::string check_rows(std::string_view name, PointsView rows,
                       bool (*good)(const Eigen::Vector3f&) noexcept, std::string_view expected) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!good(rows[i])) {
      return fmt::format("{}[{}]: expected {}, found ({}, {}, {})", name, i, expected, rows.x[i],
                         rows.y[i], rows.z[i]);
    }
  }
  return {};
}

std::string check_points(std::string_view name, PointsView rows) {
  return check_rows(name, rows, is_point, "coordinates of at most 1e12");
}
std::string check_normals(std::string_view name, PointsView rows) {
  return check_rows(name, rows, unit, "a unit vector");
}

std::string check_distance(std::string_view name, float found) {
  return is_length(found)
             ? std::string()
             : fmt::format("{}: expected a length from 1e-12 to 1e12, found {}", name, found);
}

std::string check_length(std::string_view name, std::size_t found, std::size_t expected) {
  return found == expected
             ? std::string()
             : fmt::format("{}: expected {}, found {}", name, counted(expected, "row"), found);
}

std::string check_ranks(std::string_view name, std::span<const std::uint32_t> models,
                        std::size_t num_models) {
  const bool good = std::ranges::all_of(models, [&](std::uint32_t m) { return m < num_models; });
  return good ? std::string() : fmt::format("{}: expected numbers below {}", name, num_models);
}

std::string check_scalars(const ModelInfo& model) {
  if (std::string wrong = check_distance("diameter", model.diameter); !wrong.empty()) return wrong;
  if (!is_point(model.center)) return "center: expected coordinates of at most 1e12";
  if (model.sample_spacing != 0) {
    if (std::string wrong = check_distance("sample_spacing", model.sample_spacing); !wrong.empty())
      return wrong;
  }
  for (const std::string* text : {&model.source, &model.source_xxh3}) {
    if (text->size() > 4096 || text->find('\0') != std::string::npos)
      return "source: expected a text of at most 4096 bytes without NUL";
  }
  if (!model.fingerprint.empty() && !Xxh3::parse(model.fingerprint))
    return fmt::format("fingerprint: expected 32 hexadecimal digits, found '{}'",
                       model.fingerprint);
  return {};
}

std::string check_motions(std::string_view name, const std::vector<Pose>& motions) {
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const Eigen::Matrix4f pose = motions[i].matrix();
    const Eigen::Matrix3f turn = pose.topLeftCorner<3, 3>();
    const bool rigid = is_point(pose.topRightCorner<3, 1>()) &&
                       (turn * turn.transpose()).isIdentity(kUnitTolerance) &&
                       turn.determinant() > 0 && pose.row(3) == Eigen::RowVector4f(0, 0, 0, 1);
    if (!rigid) return fmt::format("{}[{}]: expected a rigid motion", name, i);
  }
  return {};
}

std::string check_axis(std::string_view name, const std::optional<Symmetry::Axis>& axis) {
  if (!axis || (unit(axis->direction) && is_point(axis->point))) return {};
  return fmt::format("{}: expected a unit direction and a point within 1e12", name);
}

std::string check_near_symmetries(const std::vector<Pose>& motions) {
  if (motions.size() > kMaxNearSymmetries) {
    return fmt::format("near_symmetries: expected at most {} motions, found {}", kMaxNearSymmetries,
                       motions.size());
  }
  return check_motions("near_symmetries", motions);
}

std::string check_triangles(const ModelSurface& model) {
  const TrianglesView& triangles = model.triangles;
  if (triangles.b.size() != triangles.size() || triangles.c.size() != triangles.size()) {
    return "triangles: expected three columns of one length";
  }
  for (const std::span<const std::uint32_t> corner : {triangles.a, triangles.b, triangles.c}) {
    const auto worst = std::ranges::max_element(corner);
    if (worst != corner.end() && *worst >= model.vertices.size()) {
      return fmt::format("triangles[{}]: expected an index below {}, found {}",
                         worst - corner.begin(), model.vertices.size(), *worst);
    }
  }
  return {};
}

/// Check the quantization of the table.
std::string check_quantization(const PpfQuantization& q, bool has_columns) {
  if (q == PpfQuantization{} && !has_columns) return {};  // trained without pairs
  if (std::string wrong = check_distance("ppf@distance_step", q.distance_step); !wrong.empty())
    return wrong;
  if (q.num_distance_bins == 0 && !has_columns) return {};  // trained without pairs: the step stays
  constexpr std::uint32_t kMaxBins = 65536;
  const double num_cells =
      static_cast<double>(q.num_distance_bins) * std::pow(static_cast<double>(q.num_angle_bins), 3);
  if (q.num_distance_bins > kMaxBins || q.num_angle_bins > kMaxBins || num_cells < 1 ||
      num_cells >= 4294967295.0) {
    return fmt::format("ppf@num_angle_bins: expected 1 to 2^32 - 2 cells, found {} x {}^3",
                       q.num_distance_bins, q.num_angle_bins);
  }
  return {};
}

bool has_columns(const PpfTableView& table) noexcept {
  return !table.offsets.empty() || !table.entries.empty();
}

/// Whether an entry precedes the one before it in the order of (reference, angle).
bool falls_before(std::span<const PpfEntry> entries, std::size_t i) {
  const std::uint32_t before = std::uint32_t{entries[i - 1].reference} << 16 | entries[i - 1].angle;
  const std::uint32_t here = std::uint32_t{entries[i].reference} << 16 | entries[i].angle;
  return here < before;
}

/// Whether all references exist and each cell is sorted. The order may decrease only at the start
/// of a cell, so that all entries are compared in one pass, independently of the cells.
TRIVET_SIMD_CLONES
bool entries_in_order(std::span<const PpfEntry> entries, std::span<const std::uint32_t> starts,
                      std::size_t num_references) {
  const std::size_t n = entries.size();
  std::uint32_t highest = 0, num_falls = 0, num_at_starts = 0;
  for (std::size_t i = 0; i < n; ++i)
    highest = std::max(highest, std::uint32_t{entries[i].reference});
  for (std::size_t i = 1; i < n; ++i) num_falls += falls_before(entries, i) ? 1 : 0;
  std::uint32_t last = 0;
  for (const std::uint32_t start : starts) {
    if (start == last || start >= n) continue;  // also for empty cells
    num_at_starts += falls_before(entries, start) ? 1 : 0;
    last = start;
  }
  return (n == 0 || highest < num_references) && num_falls == num_at_starts;
}

std::string check_table(const PpfTableView& table, std::size_t num_points) {
  const PpfQuantization& q = table.quantization;
  if (q.num_distance_bins == 0 && !has_columns(table)) return {};  // trained without pairs
  if (num_points > 65536)
    return fmt::format("ppf/points: expected at most 65536, found {}", num_points);
  if (table.num_references > num_points) {
    return fmt::format("ppf@num_references: expected at most {}, found {}", num_points,
                       table.num_references);
  }
  const std::size_t cells = q.num_cells();
  if (auto wrong = check_length("ppf/offsets", table.offsets.size(), cells + 1); !wrong.empty())
    return wrong;

  const auto offsets = table.offsets;
  if (offsets.front() != 0)
    return fmt::format("ppf/offsets[0]: expected 0, found {}", offsets.front());
  const auto falling = std::ranges::is_sorted_until(offsets);
  if (falling != offsets.end()) {
    return fmt::format("ppf/offsets[{}]: expected at least {}, found {}", falling - offsets.begin(),
                       *(falling - 1), *falling);
  }
  if (auto wrong = check_length("ppf/entries", table.entries.size(), offsets.back());
      !wrong.empty())
    return wrong;

  const auto entries = table.entries;
  const auto starts = offsets.first(cells);
  if (entries_in_order(entries, starts, table.num_references)) return {};
  for (std::size_t cell = 0; cell < cells; ++cell) {
    for (std::size_t i = offsets[cell]; i < offsets[cell + 1]; ++i) {
      if (entries[i].reference >= table.num_references) {
        return fmt::format("ppf/entries[{}]: expected a reference below {}, found {}", i,
                           table.num_references, entries[i].reference);
      }
      if (i > offsets[cell] && falls_before(entries, i)) {
        return fmt::format("ppf/entries[{}]: expected cell {} sorted by reference, then angle", i,
                           cell);
      }
    }
  }
  return {};
}

std::string check_resolution(std::string_view group, const TriSpinFeatures& features) {
  if (features.size() == 0) return {};
  return check_distance(fmt::format("{}@resolution", group), features.resolution);
}

std::string check_features(std::string_view group, const TriSpinFeatures& features) {
  if (features.size() == 0 && features.frames.empty() && features.codes.empty()) return {};
  if (auto wrong = check_points(fmt::format("{}/keypoints", group), features.keypoints);
      !wrong.empty())
    return wrong;
  if (auto wrong =
          check_length(fmt::format("{}/frames", group), features.frames.size(), features.size());
      !wrong.empty())
    return wrong;
  if (features.codes.size() != features.size() * features.num_components) {
    return fmt::format("{}/features: expected {} rows of {}, found {} numbers", group,
                       features.size(), features.num_components, features.codes.size());
  }
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> frame(
        features.frames[i].data());
    if (!frame.allFinite() || !(frame * frame.transpose()).isIdentity(kUnitTolerance) ||
        frame.determinant() < 0)
      return fmt::format("{}/frames[{}]: expected a rotation", group, i);
  }
  return {};
}

/// The first fault that a check finds in the features of a model.
template <class Check>
std::string at_each_scale(const ModelFeatures& model, Check&& check) {
  for (std::size_t k = 0; k < model.features.size(); ++k) {
    if (std::string wrong = check(kFeatureGroups[k], model.features[k]); !wrong.empty())
      return wrong;
  }
  return {};
}

std::string check_numbers(std::string_view name, std::span<const float> numbers) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!std::isfinite(numbers[i]))
      return fmt::format("{}[{}]: expected a finite number, found {}", name, i, numbers[i]);
  }
  return {};
}

/// Without any view, no sample would ever be tested, and the model never be found.
std::string check_views(const ModelSamples& model) {
  const std::span<const ViewMask> views = model.sample_views;
  std::string wrong = check_length("sample_views", views.size(), model.samples.size());
  if (!wrong.empty()) return wrong;
  const bool any_visible =
      std::ranges::any_of(views, [](const ViewMask& mask) { return mask != ViewMask{}; });
  return any_visible
             ? ""
             : "sample_views: expected directions from which samples are visible, found no bit set";
}

}  // namespace

Result<void> check_basis(const TriSpinBasis& basis) {
  const PcaBasis& pca = basis.components;
  std::string wrong;
  if (!(basis.support >= 1 / kMostSupport && basis.support <= kMostSupport)) {
    wrong = fmt::format("support: expected a number from {} to {}, found {}", 1 / kMostSupport,
                        kMostSupport, basis.support);
  } else if (!is_length(basis.code_step)) {
    wrong =
        fmt::format("code_step: expected a number from 1e-12 to 1e12, found {}", basis.code_step);
  } else if (pca.size() == 0 || pca.size() > kImageSize) {
    wrong = fmt::format("energies: expected 1 to {} rows, found {}", kImageSize, pca.size());
  } else if (pca.dimension != kImageSize || pca.mean.size() != kImageSize) {
    wrong = fmt::format("mean: expected {} numbers, found {}", kImageSize, pca.mean.size());
  } else {
    wrong = check_length("components", pca.components.size() / kImageSize, pca.size());
  }
  if (wrong.empty()) wrong = check_numbers("mean", pca.mean);
  if (wrong.empty()) wrong = check_numbers("components", pca.components);
  if (wrong.empty()) wrong = check_numbers("energies", pca.energies);
  if (wrong.empty()) return {};
  return Error{ErrorCode::bad_data, "trisi/" + wrong};
}

namespace {

/// Run checks of a model's data, until the first one that finds a fault.
template <class Data>
Result<void> run(std::string_view name, const Data& data,
                 std::initializer_list<std::string (*)(const Data&)> checks) {
  for (const auto check : checks) {
    if (const std::string wrong = check(data); !wrong.empty())
      return Error{ErrorCode::bad_data, fmt::format("model '{}': {}", name, wrong)};
  }
  return {};
}

}  // namespace

Result<void> check_traits(const Model& model) {
  if (!is_model_name(model.name)) {
    return Error{ErrorCode::bad_data,
                 fmt::format("model name '{}': expected {}; rename the model with NAME=FILE",
                             model.name, kModelNameRule)};
  }
  return run<Model>(
      model.name, model,
      {[](const Model& m) { return check_scalars(m); },
       [](const Model& m) { return check_axis("symmetry axis", m.symmetry.axis); },
       [](const Model& m) { return check_motions("symmetry_poses", m.symmetry.poses); },
       [](const Model& m) { return check_near_symmetries(m.near_symmetries); },
       [](const Model& m) { return check_axis("near_axis", m.near_axis); },
       [](const Model& m) { return check_quantization(m.ppf.quantization, has_columns(m.ppf)); },
       [](const Model& m) {
         return at_each_scale(m, [](std::string_view group, const auto& features) {
           return check_resolution(group, features);
         });
       }});
}

Result<void> check_part(std::string_view name, const ModelColumns& columns, ModelPart part) {
  switch (part) {
    case ModelPart::surface:
      return run<ModelSurface>(
          name, columns,
          {[](const ModelSurface& m) { return check_points("vertices", m.vertices); },
           [](const ModelSurface& m) { return check_triangles(m); }});
    case ModelPart::samples:
      return run<ModelSamples>(
          name, columns,
          {[](const ModelSamples& m) { return check_points("samples", m.samples); },
           [](const ModelSamples& m) {
             return check_length("sample_normals", m.sample_normals.size(), m.samples.size());
           },
           [](const ModelSamples& m) { return check_normals("sample_normals", m.sample_normals); },
           [](const ModelSamples& m) { return check_views(m); }});
    case ModelPart::pairs:
      return run<ModelPairs>(
          name, columns,
          {[](const ModelPairs& m) { return check_points("ppf/points", m.ppf_points); },
           [](const ModelPairs& m) {
             return check_length("ppf/normals", m.ppf_normals.size(), m.ppf_points.size());
           },
           [](const ModelPairs& m) { return check_normals("ppf/normals", m.ppf_normals); },
           [](const ModelPairs& m) { return check_table(m.ppf, m.ppf_points.size()); }});
    case ModelPart::features:
      return run<ModelFeatures>(name, columns, {[](const ModelFeatures& m) {
                                  return at_each_scale(
                                      m, [](std::string_view group, const auto& features) {
                                        return check_features(group, features);
                                      });
                                }});
  }
  return {};
}

Result<void> check_model(const Model& model) {
  TRIVET_TRY(check_traits(model));
  for (const ModelPart part : kModelParts) {
    TRIVET_TRY(check_part(model.name, model, part));
  }
  return {};
}

Result<void> check_lists(const FeatureLevel& level, std::size_t num_models) {
  std::string wrong;
  if (level.offsets.size() < 2 || level.offsets.front() != 0) {
    wrong = "offsets: expected to begin at 0";
  } else {
    wrong = check_length("centroids", level.centroids.size(),
                         (level.offsets.size() - 1) * level.stride);
  }
  if (wrong.empty() && !std::ranges::is_sorted(level.offsets))
    wrong = "offsets: expected not to fall";
  if (wrong.empty()) wrong = check_ranks("models", level.models, num_models);
  if (wrong.empty() && !std::ranges::is_sorted(level.models, std::ranges::less_equal()))
    wrong = "models: expected them to rise";
  if (wrong.empty()) return {};
  return Error{ErrorCode::bad_data, wrong};
}

Result<void> check_listed(std::span<const std::uint32_t> model, PointsView keypoints,
                          std::size_t num_models) {
  std::string wrong = check_ranks("model", model, num_models);
  if (wrong.empty()) wrong = check_points("keypoints", keypoints);
  if (wrong.empty()) return {};
  return Error{ErrorCode::bad_data, wrong};
}

Result<void> check_level(const FeatureLevel& level, std::size_t num_models) {
  TRIVET_TRY(check_lists(level, num_models));
  const std::size_t n = level.size();
  std::string wrong = check_length("offsets", level.offsets.back(), n);
  const auto rows = [&](std::string_view name, std::size_t found, std::size_t expected) {
    if (wrong.empty()) wrong = check_length(name, found, expected);
  };
  rows("keypoints", level.keypoints.size(), n);
  rows("frames", level.frames.size(), n);
  rows("codes", level.codes.size(), n * level.stride);
  if (!wrong.empty()) return Error{ErrorCode::bad_data, wrong};
  return check_listed(level.model, level.keypoints, num_models);
}

}  // namespace trivet::format
