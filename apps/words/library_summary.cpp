#include "apps/words/library_summary.hpp"

#include <fmt/format.h>

#include <numeric>

#include "apps/inputs/inputs.hpp"
#include "storage/common/counted.hpp"
#include "storage/files/json_text.hpp"

namespace trivet::apps {
namespace {

using Json = nlohmann::ordered_json;

/// Tri-Spin-Images of all models together, and their share of the file.
struct FeatureTotals {
  std::size_t number = 0;
  std::uint64_t bytes = 0;
  double energy_share = 0;  ///< share of the variance in the components
};

FeatureTotals feature_totals(const Library& library) {
  FeatureTotals totals;
  for (std::uint32_t m = 0; m < library.models.size(); ++m) {
    for (const ModelShape::Features& features : library.shape(m).features) {
      totals.number += features.size;
      totals.bytes +=
          features.size * (sizeof(Eigen::Vector3f) + sizeof(FrameRows)) + features.code_bytes;
    }
  }
  for (std::size_t k = 0; k < library.index.size(); ++k) {
    const LevelShape level = library.index.shape(k);
    totals.bytes += level.code_bytes +
                    level.num_features *
                        (sizeof(Eigen::Vector3f) + sizeof(RotationCode) + sizeof(level.models[0]));
  }
  const PcaBasis& pca = library.basis.components;
  totals.energy_share =
      std::accumulate(pca.energies.begin(), pca.energies.end(), 0.0) / pca.all_energy;
  return totals;
}

std::string features_text(const Library& library) {
  const TriSpinBasis& basis = library.basis;
  if (basis.components.size() == 0) return "none";
  const FeatureTotals totals = feature_totals(library);
  return fmt::format("{} of radius {} resolutions, {} with {:.1f} % of the variance, {}",
                     counted(totals.number, "Tri-Spin-Image"), basis.support,
                     counted(basis.components.size(), "component"), 100 * totals.energy_share,
                     counted(totals.bytes, "byte"));
}

Json features_json(const Library& library) {
  const TriSpinBasis& basis = library.basis;
  if (basis.components.size() == 0) return nullptr;
  const FeatureTotals totals = feature_totals(library);
  return {{"number", totals.number},
          {"support", basis.support},
          {"components", basis.components.size()},
          {"energy_share", totals.energy_share},
          {"bytes", totals.bytes}};
}

std::string symmetry_text(const Symmetry& symmetry) {
  if (symmetry.trivial()) return "none";
  std::string text;
  if (symmetry.axis) text = "axis";
  if (!symmetry.poses.empty())
    text += (text.empty() ? "" : " + ") + counted(symmetry.poses.size(), "pose");
  return text + (symmetry.declared ? " (declared)" : " (found)");
}

std::string near_text(const ModelInfo& model) {
  return fmt::format("{}{}", model.near_axis ? "axis + " : "", model.near_symmetries.size());
}

Json vector_json(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }

Json axis_json(const std::optional<Symmetry::Axis>& axis) {
  if (!axis) return nullptr;
  return {{"direction", vector_json(axis->direction)}, {"point", vector_json(axis->point)}};
}

Json pairs_json(const ModelShape& shape) {
  if (!shape.has_pairs()) return nullptr;
  const PpfQuantization& quantization = shape.quantization;
  return {{"points", shape.num_ppf_points},
          {"references", shape.num_references},
          {"pairs", shape.num_ppf_entries},
          {"distance_step", quantization.distance_step},
          {"distance_bins", quantization.num_distance_bins},
          {"angle_bins", quantization.num_angle_bins}};
}

Json model_json(const ModelInfo& model, const ModelShape& shape) {
  return {{"name", model.name},
          {"source", model.source},
          {"source_xxh3", model.source_xxh3},
          {"fingerprint", model.fingerprint},
          {"diameter", model.diameter},
          {"center", vector_json(model.center)},
          {"vertices", shape.num_vertices},
          {"triangles", shape.num_triangles},
          {"samples", shape.num_samples},
          {"sample_spacing", model.sample_spacing},
          {"symmetry",
           {{"axis", axis_json(model.symmetry.axis)},
            {"poses", model.symmetry.poses.size()},
            {"declared", model.symmetry.declared}}},
          {"near_symmetry",
           {{"axis", axis_json(model.near_axis)}, {"poses", model.near_symmetries.size()}}},
          {"point_pairs", pairs_json(shape)},
          {"features", shape.num_features()}};
}

Json parameters_json(const std::string& parameters) {
  Json json = parse_json<Json>(parameters);
  return json.is_discarded() ? Json(parameters) : json;
}

std::string format_version(const Library& library) {
  return fmt::format("{}.{}", kLibraryVersionMajor, library.version_minor);
}

}  // namespace

std::string library_text(const Library& library) {
  const char* const unit = unit_name(library.header.unit);
  std::string text = fmt::format(
      "file        {}\nsize        {} bytes\nformat      {}\nproducer    {}\nunit        "
      "{}\nparameters  {}\n"
      "models      {}\nfeatures    {}\n\n",
      library.file.string(), library.file_bytes, format_version(library), library.header.producer,
      unit, library.header.parameters, library.models.size(), features_text(library));
  text += fmt::format("{:<32} {:>12} {:>9} {:>9} {:>9} {:>12} {:>10} {:>9} {:>9}  {}\n", "model",
                      fmt::format("diameter[{}]", unit), "vertices", "samples", "points", "pairs",
                      fmt::format("step[{}]", unit), "features", "near", "symmetry");
  for (std::uint32_t m = 0; m < library.models.size(); ++m) {
    const ModelInfo& model = library.models[m];
    const ModelShape shape = library.shape(m);
    text +=
        fmt::format("{:<32} {:>12.5g} {:>9} {:>9} {:>9} {:>12} {:>10.4g} {:>9} {:>9}  {}\n",
                    model.name, model.diameter, shape.num_vertices, shape.num_samples,
                    shape.num_ppf_points, shape.num_ppf_entries, shape.quantization.distance_step,
                    shape.num_features(), near_text(model), symmetry_text(model.symmetry));
  }
  return text;
}

nlohmann::ordered_json library_json(const Library& library) {
  Json models = Json::array();
  for (std::uint32_t m = 0; m < library.models.size(); ++m)
    models.push_back(model_json(library.models[m], library.shape(m)));
  return {{"file", library.file.string()},
          {"bytes", library.file_bytes},
          {"format", format_version(library)},
          {"producer", library.header.producer},
          {"unit", unit_name(library.header.unit)},
          {"parameters", parameters_json(library.header.parameters)},
          {"features", features_json(library)},
          {"models", std::move(models)}};
}

}  // namespace trivet::apps
