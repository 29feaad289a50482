// What is known of models, from their groups.
#include <algorithm>

#include "storage/common/columns.hpp"
#include "storage/library/model_record.hpp"

namespace trivet {
namespace {

/// The columns of a group of the format, below a model's own.
void take_columns(Taker& take, const StoredGroup& group, std::string_view spec_group,
                  const std::string& path, ModelRecord& record) {
  for (std::size_t c = 0; c < format::kModelColumns.size(); ++c) {
    const format::DatasetSpec& spec = format::kModelColumns[c].spec;
    if (spec.group != spec_group) continue;
    record.columns[c] = take.column(group, spec, path).value_or(StoredColumn{});
  }
}

void take_features(Taker& take, const StoredGroup& model, const std::string& name,
                   const std::string& path, TriSpinFeatures& features, ModelRecord& record) {
  const StoredGroup* const group = Taker::below(model, name);
  const std::string place = path + "/" + name;
  if (take.num_components() == 0) {
    if (group != nullptr) take.refuse(place, "expected the group /trisi beside it, found none");
  } else if (group != nullptr) {
    features.resolution = take.f32(group->attributes, "resolution", place);
    take.expect_only(*group, name, {}, place);
    take_columns(take, *group, name, place, record);
  } else {
    take.refuse(place, "expected this group, found none");
  }
}

ModelRecord take_model(Taker& take, const std::string& name, const StoredGroup& group) {
  const std::string path = "/models/" + name;
  ModelRecord record;
  Model& model = record.traits;
  model.name = name;
  model.source = take.text(group.attributes, "source", path);
  model.source_xxh3 = take.text(group.attributes, "source_xxh3", path);
  if (take.version() >= format::kFingerprintsSince)
    model.fingerprint = take.text(group.attributes, "fingerprint", path);
  model.diameter = take.f32(group.attributes, "diameter", path);
  model.center = take.vector(group.attributes, "centre", path);
  model.sample_spacing = take.f32(group.attributes, "sample_spacing", path);
  model.symmetry.declared = take.numbers<std::uint8_t, 1>(group.attributes, "symmetry_declared",
                                                          ElementType::u8, path)[0] != 0;
  const Eigen::Vector3f direction = take.vector(group.attributes, "symmetry_axis_direction", path);
  const Eigen::Vector3f point = take.vector(group.attributes, "symmetry_axis_point", path);
  if (direction != Eigen::Vector3f::Zero()) model.symmetry.axis = Symmetry::Axis{direction, point};
  model.symmetry.poses = poses_of(take.values<float>(group, format::kSymmetryPoses, path));
  model.near_symmetries = poses_of(take.values<float>(group, format::kNearSymmetries, path));
  const std::vector<float> axes = take.values<float>(group, format::kNearAxis, path);
  if (axes.size() > 6) take.refuse(path + "/near_axis", "expected one axis at most");
  if (axes.size() >= 6)
    model.near_axis = {Eigen::Vector3f(axes.data()), Eigen::Vector3f(axes.data() + 3)};
  take.expect_only(group, "", {"ppf", "trisi", "trisi_2x", "trisi_4x"}, path);
  take_columns(take, group, "", path, record);

  if (const StoredGroup* const table = Taker::below(group, "ppf")) {
    const std::string place = path + "/ppf";
    model.ppf.quantization = {take.f32(table->attributes, "distance_step", place),
                              take.u32(table->attributes, "num_distance_bins", place),
                              take.u32(table->attributes, "num_angle_bins", place)};
    model.ppf.num_references = take.u32(table->attributes, "num_references", place);
    take.expect_only(*table, "ppf", {}, place);
    take_columns(take, *table, "ppf", place, record);
  } else {
    take.refuse(path + "/ppf", "expected this group, found none");
  }

  for (std::size_t k = 0; k < kFeatureScales.size(); ++k) {
    if (take.version() < format::at_scale(format::kFeatures, k).since) continue;
    take_features(take, group, std::string(format::kFeatureGroups[k]), path, model.features[k],
                  record);
  }
  return record;
}

}  // namespace

std::vector<ModelRecord> take_models(Taker& take, const StoredGroup& models) {
  std::vector<ModelRecord> records;
  for (const auto& [name, group] : models.groups) {
    records.push_back(take_model(take, name, group));
    if (take.fault()) return {};
  }
  return records;
}

}  // namespace trivet
