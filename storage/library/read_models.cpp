// Metadata of models from their groups.
#include <algorithm>

#include "storage/common/columns.hpp"
#include "storage/library/model_record.hpp"

namespace trivet {
namespace {

/// Read the columns of a group of the format, below a model's group.
void read_columns(GroupReader& reader, const StoredGroup& group, std::string_view spec_group,
                  const std::string& path, const format::RowSizes& sizes, ModelRecord& record) {
  for (std::size_t c = 0; c < format::kModelColumns.size(); ++c) {
    const format::DatasetSpec& spec = format::kModelColumns[c].spec;
    if (spec.group != spec_group) continue;
    record.columns[c] = reader.column(group, spec, path, sizes).value_or(StoredColumn{});
  }
}

/// Read the features of one of kFeatureScales.
void read_features(GroupReader& reader, const StoredGroup& model, std::size_t scale,
                   const std::string& path, std::size_t num_components, ModelRecord& record) {
  const std::string name(format::kFeatureGroups[scale]);
  const StoredGroup* const group = GroupReader::below(model, name);
  const std::string place = path + "/" + name;
  if (num_components == 0) {
    if (group != nullptr) reader.refuse(place, "expected the group /trisi beside it, found none");
  } else if (group != nullptr) {
    record.traits.features[scale].resolution = reader.f32(group->attributes, "resolution", place);
    reader.expect_only(*group, name, {}, place);
    read_columns(reader, *group, name, place, {.components = num_components}, record);
  } else {
    reader.refuse(place, "expected this group, found none");
  }
}

ModelRecord read_model(GroupReader& reader, const std::string& name, const StoredGroup& group,
                       std::size_t num_components) {
  const std::string path = "/models/" + name;
  ModelRecord record;
  Model& model = record.traits;
  model.name = name;
  model.source = reader.text(group.attributes, "source", path);
  model.source_xxh3 = reader.text(group.attributes, "source_xxh3", path);
  if (reader.version() >= format::kFingerprintsSince)
    model.fingerprint = reader.text(group.attributes, "fingerprint", path);
  model.diameter = reader.f32(group.attributes, "diameter", path);
  model.center = reader.vector(group.attributes, "centre", path);
  model.sample_spacing = reader.f32(group.attributes, "sample_spacing", path);
  model.symmetry.declared = reader.numbers<std::uint8_t, 1>(group.attributes, "symmetry_declared",
                                                            ElementType::u8, path)[0] != 0;
  const Eigen::Vector3f direction =
      reader.vector(group.attributes, "symmetry_axis_direction", path);
  const Eigen::Vector3f point = reader.vector(group.attributes, "symmetry_axis_point", path);
  if (direction != Eigen::Vector3f::Zero()) model.symmetry.axis = Symmetry::Axis{direction, point};
  model.symmetry.poses = poses_of(reader.values<float>(group, format::kSymmetryPoses, path));
  model.near_symmetries = poses_of(reader.values<float>(group, format::kNearSymmetries, path));
  const std::vector<float> axes = reader.values<float>(group, format::kNearAxis, path);
  if (axes.size() > 6) reader.refuse(path + "/near_axis", "expected one axis at most");
  if (axes.size() >= 6)
    model.near_axis = {Eigen::Vector3f(axes.data()), Eigen::Vector3f(axes.data() + 3)};
  reader.expect_only(group, "", {"ppf", "trisi", "trisi_2x", "trisi_4x"}, path);
  read_columns(reader, group, "", path, {}, record);

  if (const StoredGroup* const table = GroupReader::below(group, "ppf")) {
    const std::string place = path + "/ppf";
    model.ppf.quantization = {reader.f32(table->attributes, "distance_step", place),
                              reader.u32(table->attributes, "num_distance_bins", place),
                              reader.u32(table->attributes, "num_angle_bins", place)};
    model.ppf.num_references = reader.u32(table->attributes, "num_references", place);
    reader.expect_only(*table, "ppf", {}, place);
    read_columns(reader, *table, "ppf", place, {}, record);
  } else {
    reader.refuse(path + "/ppf", "expected this group, found none");
  }

  for (std::size_t k = 0; k < kFeatureScales.size(); ++k) {
    if (reader.version() < format::at_scale(format::kFeatures, k).since) continue;
    read_features(reader, group, k, path, num_components, record);
  }
  return record;
}

}  // namespace

std::vector<ModelRecord> read_models(GroupReader& reader, const StoredGroup& models,
                                     std::size_t num_components) {
  std::vector<ModelRecord> records;
  for (const auto& [name, group] : models.groups) {
    records.push_back(read_model(reader, name, group, num_components));
    if (reader.fault()) return {};
  }
  return records;
}

}  // namespace trivet
