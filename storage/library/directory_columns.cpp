#include "storage/library/directory_columns.hpp"

#include <string_view>

#include "storage/library/library_format.hpp"

namespace trivet {
namespace {

void add_vector(const Eigen::Vector3f& v, std::vector<float>& out) {
  out.insert(out.end(), v.data(), v.data() + 3);
}

void add_axis(const std::optional<Symmetry::Axis>& axis, std::vector<float>& out) {
  const Symmetry::Axis a = axis.value_or(Symmetry::Axis{{0, 0, 0}, {0, 0, 0}});
  add_vector(a.direction, out);
  add_vector(a.point, out);
}

}  // namespace

ModelRecord record_of(const Model& model, const StoredGroup& described) {
  ModelRecord record;
  Model& traits = record.traits;
  traits.name = model.name;
  traits.source = model.source;
  traits.source_xxh3 = model.source_xxh3;
  traits.fingerprint = model.fingerprint;
  traits.diameter = model.diameter;
  traits.center = model.center;
  traits.sample_spacing = model.sample_spacing;
  traits.symmetry = model.symmetry;
  traits.near_symmetries = model.near_symmetries;
  traits.near_axis = model.near_axis;
  traits.ppf.quantization = model.ppf.quantization;
  traits.ppf.num_references = model.ppf.num_references;
  for (std::size_t k = 0; k < model.features.size(); ++k)
    traits.features[k].resolution = model.features[k].resolution;
  for (std::size_t c = 0; c < format::kModelColumns.size(); ++c) {
    const format::DatasetSpec& spec = format::kModelColumns[c].spec;
    const StoredGroup* const group =
        spec.group.empty() ? &described : GroupReader::below(described, std::string(spec.group));
    if (group == nullptr) continue;
    const StoredDataset& dataset = group->datasets.at(std::string(spec.name));
    const StoredAttribute& sum = dataset.attributes.at(std::string(format::kDataChecksum));
    const std::string_view hex(reinterpret_cast<const char*>(sum.bytes.data()), sum.bytes.size());
    record.columns[c] = {dataset.offset, dataset.bytes, Xxh3::parse(hex).value_or(Xxh3{})};
  }
  return record;
}

void DirectoryColumns::add(const ModelRecord& record) {
  const Model& model = record.traits;
  std::string name = model.name;
  name.resize(format::kNameBytes, '\0');
  names += name;
  for (const std::string* const text : {&model.source, &model.source_xxh3}) {
    texts += *text;
    text_ends.push_back(texts.size());
  }
  const Xxh3 fingerprint = Xxh3::parse(model.fingerprint).value_or(Xxh3{});
  fingerprints.insert(fingerprints.end(), {fingerprint.high, fingerprint.low});
  diameter.push_back(model.diameter);
  add_vector(model.center, center);
  spacing.push_back(model.sample_spacing);
  add_axis(model.symmetry.axis, axis);
  declared.push_back(model.symmetry.declared ? 1 : 0);
  add_axis(model.near_axis, near_axis);
  for (const std::vector<Pose>* const of_kind : {&model.symmetry.poses, &model.near_symmetries}) {
    motions.insert(motions.end(), of_kind->begin(), of_kind->end());
    motion_ends.push_back(motions.size());
  }
  const PpfQuantization& quantization = model.ppf.quantization;
  step.push_back(quantization.distance_step);
  counts.insert(counts.end(), {model.ppf.num_references, quantization.num_distance_bins,
                               quantization.num_angle_bins});
  for (const TriSpinFeatures& features : model.features) resolution.push_back(features.resolution);
  for (const StoredColumn& column : record.columns) {
    places.insert(places.end(), {column.offset, column.bytes});
    checksums.insert(checksums.end(), {column.checksum.high, column.checksum.low});
  }
}

}  // namespace trivet
