#include "storage/library/packed_model.hpp"

#include <fmt/format.h>

#include <span>

#include "storage/library/library.hpp"
#include "storage/library/write_hdf5.hpp"

namespace trivet {
namespace {

using hdf5::attribute;
using hdf5::gather;

StoredAttributes model_attributes(const Model& model) {
  const Symmetry::Axis axis = model.symmetry.axis.value_or(Symmetry::Axis{{0, 0, 0}, {0, 0, 0}});
  StoredAttributes out;
  out.emplace("source", attribute(model.source));
  out.emplace("source_xxh3", attribute(model.source_xxh3));
  out.emplace("fingerprint", attribute(model.fingerprint));
  out.emplace("diameter", attribute(model.diameter));
  out.emplace("centre", attribute(model.center));
  out.emplace("sample_spacing", attribute(model.sample_spacing));
  out.emplace("symmetry_declared", attribute(model.symmetry.declared));
  out.emplace("symmetry_axis_direction", attribute(Eigen::Vector3f(axis.direction)));
  out.emplace("symmetry_axis_point", attribute(Eigen::Vector3f(axis.point)));
  return out;
}

StoredAttributes table_attributes(const PpfTableView& table) {
  const PpfQuantization& quantization = table.quantization;
  StoredAttributes out;
  out.emplace("num_references", attribute(table.num_references));
  out.emplace("distance_step", attribute(quantization.distance_step));
  out.emplace("num_distance_bins", attribute(quantization.num_distance_bins));
  out.emplace("num_angle_bins", attribute(quantization.num_angle_bins));
  return out;
}

void add_own(const Model& model, PackedGroup& group) {
  const TrianglesView& triangles = model.triangles;
  group.described.attributes = model_attributes(model);
  group.add(format::kVertices, gather(model.vertices));
  group.add(format::kTriangles, gather<std::uint32_t>({triangles.a, triangles.b, triangles.c}));
  group.add(format::kSamples, gather(model.samples));
  group.add(format::kSampleNormals, gather(model.sample_normals));
  group.add(format::kSampleViews, std::as_bytes(std::span(model.sample_views)));
  group.add(format::kSymmetryPoses, gather(model.symmetry.poses));
  group.add(format::kNearSymmetries, gather(model.near_symmetries));
  group.add(format::kNearAxis, gather(model.near_axis));
}

void add_pairs(const Model& model, PackedGroup& group) {
  group.described.attributes = table_attributes(model.ppf);
  group.add(format::kPpfPoints, gather(model.ppf_points));
  group.add(format::kPpfNormals, gather(model.ppf_normals));
  group.add(format::kPpfOffsets, std::as_bytes(model.ppf.offsets));
  group.add(format::kPpfEntries, std::as_bytes(model.ppf.entries));
}

void add_features(const TriSpinFeatures& features, PackedGroup& group) {
  group.described.attributes.emplace("resolution", attribute(features.resolution));
  group.add(format::kKeypoints, gather(features.keypoints));
  group.add(format::kFrames, std::as_bytes(std::span(features.frames)));
  group.add(format::kFeatures, std::as_bytes(std::span(features.codes)));
}

std::uint64_t bytes_of(const PackedGroup& group) {
  std::uint64_t sum = 0;
  for (const auto& [name, dataset] : group.described.datasets) sum += dataset.bytes;
  return sum;
}

}  // namespace

std::uint64_t packed_bytes(const PackedModel& packed) noexcept {
  std::uint64_t sum = bytes_of(packed.own);
  for (const auto& [name, part] : packed.parts) sum += bytes_of(part);
  return sum;
}

StoredGroup PackedModel::described() const {
  StoredGroup all = own.described;
  for (const auto& [name, part] : parts) all.groups.emplace(name, part.described);
  return all;
}

Result<std::shared_ptr<PackedModel>> pack_model(const Model& model, LengthUnit unit,
                                                std::size_t num_components) {
  TRIVET_TRY(format::check_model(model));
  for (const TriSpinFeatures& features : model.features) {
    if (features.size() == 0 || features.num_components == num_components) continue;
    return Error{ErrorCode::bad_data,
                 fmt::format("model '{}': expected features of {} components, found {}", model.name,
                             num_components, features.num_components)};
  }
  const PackedGroup empty(unit_name(unit), num_components);
  auto packed = std::make_shared<PackedModel>(PackedModel{model, empty, {}});
  add_own(packed->model, packed->own);
  add_pairs(packed->model, packed->parts.emplace_back("ppf", empty).second);
  for (std::size_t k = 0; num_components > 0 && k < model.features.size(); ++k) {
    add_features(packed->model.features[k],
                 packed->parts.emplace_back(format::kFeatureGroups[k], empty).second);
  }
  return packed;
}

}  // namespace trivet
