// What a model must be for recognition to use it without further checks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "storage/counted.hpp"
#include "storage/library/library_format.hpp"
#include "storage/model_name.hpp"

namespace trivet::format {
namespace {

constexpr float kUnitTolerance = 1e-3F;  // of the squared length; float rounding stays below 1e-6

bool finite(const Eigen::Vector3f& v) noexcept { return v.allFinite(); }
bool unit(const Eigen::Vector3f& v) noexcept {
  return std::abs(v.squaredNorm() - 1) <= kUnitTolerance;
}

/// Each check gives an empty text, or what is wrong and where.
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
  return check_rows(name, rows, finite, "finite coordinates");
}
std::string check_normals(std::string_view name, PointsView rows) {
  return check_rows(name, rows, unit, "a unit vector");
}

std::string check_length(std::string_view name, std::size_t found, std::size_t expected) {
  return found == expected
             ? std::string()
             : fmt::format("{}: expected {}, found {}", name, counted(expected, "row"), found);
}

std::string check_scalars(const Model& model) {
  if (!std::isfinite(model.diameter) || model.diameter <= 0) {
    return fmt::format("diameter: expected a positive length, found {}", model.diameter);
  }
  if (!finite(model.center)) return "center: expected finite coordinates";
  if (!std::isfinite(model.sample_spacing) || model.sample_spacing < 0) {
    return fmt::format("sample_spacing: expected a length, found {}", model.sample_spacing);
  }
  for (const std::string* text : {&model.source, &model.source_xxh3}) {
    if (text->size() > 4096 || text->find('\0') != std::string::npos)
      return "source: expected a text of at most 4096 bytes without NUL";
  }
  return {};
}

std::string check_motions(std::string_view name, const std::vector<Pose>& motions) {
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const Eigen::Matrix4f pose = motions[i].matrix();
    const Eigen::Matrix3f turn = pose.topLeftCorner<3, 3>();
    const bool rigid = pose.allFinite() && (turn * turn.transpose()).isIdentity(kUnitTolerance) &&
                       turn.determinant() > 0 && pose.row(3) == Eigen::RowVector4f(0, 0, 0, 1);
    if (!rigid) return fmt::format("{}[{}]: expected a rigid motion", name, i);
  }
  return {};
}

std::string check_axis(std::string_view name, const std::optional<Symmetry::Axis>& axis) {
  if (!axis || (unit(axis->direction) && finite(axis->point))) return {};
  return fmt::format("{}: expected a unit direction and a finite point", name);
}

std::string check_near_symmetries(const std::vector<Pose>& motions) {
  if (motions.size() > kMaxNearSymmetries) {
    return fmt::format("near_symmetries: expected at most {} motions, found {}", kMaxNearSymmetries,
                       motions.size());
  }
  return check_motions("near_symmetries", motions);
}

std::string check_triangles(const Model& model) {
  const Triangles& triangles = model.triangles;
  if (triangles.b.size() != triangles.size() || triangles.c.size() != triangles.size()) {
    return "triangles: expected three columns of one length";
  }
  for (const auto* corner : {&triangles.a, &triangles.b, &triangles.c}) {
    const auto worst = std::ranges::max_element(*corner);
    if (worst != corner->end() && *worst >= model.vertices.size()) {
      return fmt::format("triangles[{}]: expected an index below {}, found {}",
                         worst - corner->begin(), model.vertices.size(), *worst);
    }
  }
  return {};
}

std::string check_table(const PpfTableView& table, std::size_t num_points) {
  const PpfQuantization& q = table.quantization;
  if (q == PpfQuantization{} && table.offsets.empty() && table.entries.empty())
    return {};  // trained without
  if (!std::isfinite(q.distance_step) || q.distance_step <= 0) {
    return fmt::format("ppf@distance_step: expected a positive length, found {}", q.distance_step);
  }
  if (q.num_distance_bins == 0 && table.offsets.empty() && table.entries.empty())
    return {};  // trained without: the step stays
  if (num_points > 65536)
    return fmt::format("ppf/points: expected at most 65536, found {}", num_points);
  if (table.num_references > num_points) {
    return fmt::format("ppf@num_references: expected at most {}, found {}", num_points,
                       table.num_references);
  }

  constexpr std::uint32_t kMaxBins = 65536;
  const double num_cells =
      static_cast<double>(q.num_distance_bins) * std::pow(static_cast<double>(q.num_angle_bins), 3);
  if (q.num_distance_bins > kMaxBins || q.num_angle_bins > kMaxBins || num_cells < 1 ||
      num_cells >= 4294967295.0) {
    return fmt::format("ppf@num_angle_bins: expected 1 to 2^32 - 2 cells, found {} x {}^3",
                       q.num_distance_bins, q.num_angle_bins);
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
  const auto key = [&](std::size_t i) {
    return std::uint32_t{entries[i].reference} << 16 | entries[i].angle;
  };
  for (std::size_t cell = 0; cell < cells; ++cell) {
    for (std::size_t i = offsets[cell]; i < offsets[cell + 1]; ++i) {
      if (entries[i].reference >= table.num_references) {
        return fmt::format("ppf/entries[{}]: expected a reference below {}, found {}", i,
                           table.num_references, entries[i].reference);
      }
      if (i > offsets[cell] && key(i) < key(i - 1)) {
        return fmt::format("ppf/entries[{}]: expected cell {} sorted by reference, then angle", i,
                           cell);
      }
    }
  }
  return {};
}

std::string check_features(const TriSpinFeatures& features) {
  if (features.size() == 0 && features.frames.empty() && features.codes.empty()) return {};
  if (!std::isfinite(features.resolution) || features.resolution <= 0) {
    return fmt::format("trisi@resolution: expected a positive length, found {}",
                       features.resolution);
  }
  if (auto wrong = check_points("trisi/keypoints", features.keypoints); !wrong.empty())
    return wrong;
  if (auto wrong = check_length("trisi/frames", features.frames.size(), features.size());
      !wrong.empty())
    return wrong;
  if (features.codes.size() != features.size() * features.num_components) {
    return fmt::format("trisi/features: expected {} rows of {}, found {} numbers", features.size(),
                       features.num_components, features.codes.size());
  }
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> frame(
        features.frames[i].data());
    if (!frame.allFinite() || !(frame * frame.transpose()).isIdentity(kUnitTolerance) ||
        frame.determinant() < 0)
      return fmt::format("trisi/frames[{}]: expected a rotation", i);
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

}  // namespace

Result<void> check_basis(const TriSpinBasis& basis) {
  const PcaBasis& pca = basis.components;
  std::string wrong;
  if (!std::isfinite(basis.support) || basis.support <= 0) {
    wrong = fmt::format("support: expected a positive number, found {}", basis.support);
  } else if (!std::isfinite(basis.code_step) || basis.code_step <= 0) {
    wrong = fmt::format("code_step: expected a positive number, found {}", basis.code_step);
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

Result<void> check_model(const Model& model) {
  if (!is_model_name(model.name)) {
    return Error{ErrorCode::bad_data,
                 fmt::format("model name '{}': expected {}; rename the model with NAME=FILE",
                             model.name, kModelNameRule)};
  }
  const auto checks = {
      +[](const Model& m) { return check_scalars(m); },
      +[](const Model& m) { return check_axis("symmetry axis", m.symmetry.axis); },
      +[](const Model& m) { return check_motions("symmetry_poses", m.symmetry.poses); },
      +[](const Model& m) { return check_near_symmetries(m.near_symmetries); },
      +[](const Model& m) { return check_axis("near_axis", m.near_axis); },
      +[](const Model& m) { return check_points("vertices", m.vertices); },
      +[](const Model& m) { return check_triangles(m); },
      +[](const Model& m) { return check_points("samples", m.samples); },
      +[](const Model& m) {
        return check_length("sample_normals", m.sample_normals.size(), m.samples.size());
      },
      +[](const Model& m) { return check_normals("sample_normals", m.sample_normals); },
      +[](const Model& m) {
        return check_length("sample_views", m.sample_views.size(), m.samples.size());
      },
      +[](const Model& m) { return check_points("ppf/points", m.ppf_points); },
      +[](const Model& m) {
        return check_length("ppf/normals", m.ppf_normals.size(), m.ppf_points.size());
      },
      +[](const Model& m) { return check_normals("ppf/normals", m.ppf_normals); },
      +[](const Model& m) { return check_table(m.ppf, m.ppf_points.size()); },
      +[](const Model& m) { return check_features(m.features); },
  };
  for (const auto check : checks) {
    if (const std::string wrong = check(model); !wrong.empty()) {
      return Error{ErrorCode::bad_data, fmt::format("model '{}': {}", model.name, wrong)};
    }
  }
  return {};
}

}  // namespace trivet::format
