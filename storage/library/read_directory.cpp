// Metadata of models from the directory of a library.
#include <fmt/format.h>

#include <algorithm>

#include "storage/common/counted.hpp"
#include "storage/library/model_record.hpp"

namespace trivet {
namespace {

constexpr std::size_t kColumns = format::kModelColumns.size();
const std::string kPath = "/directory";

/// All columns of the directory; `good` if all have one row per model.
struct Columns {
  std::vector<char> names, texts;
  std::vector<std::uint64_t> text_ends, fingerprints, motion_ends, places, checksums;
  std::vector<float> diameter, center, spacing, axis, near_axis, motions, step, resolution;
  std::vector<std::uint8_t> declared;
  std::vector<std::uint32_t> counts;
};

Columns read_columns(GroupReader& reader, const StoredGroup& directory) {
  const auto values = [&]<class T>(std::vector<T>& out, const format::DatasetSpec& spec) {
    out = reader.values<T>(directory, spec, kPath);
  };
  Columns c;
  values(c.names, format::kNames);
  values(c.texts, format::kTexts);
  values(c.text_ends, format::kTextEnds);
  values(c.fingerprints, format::kFingerprints);
  values(c.diameter, format::kDiameters);
  values(c.center, format::kCenters);
  values(c.spacing, format::kSpacings);
  values(c.axis, format::kAxes);
  values(c.declared, format::kDeclared);
  values(c.near_axis, format::kNearAxes);
  values(c.motions, format::kMotions);
  values(c.motion_ends, format::kMotionEnds);
  values(c.step, format::kSteps);
  values(c.counts, format::kCounts);
  values(c.resolution, format::kResolutions);
  values(c.places, format::kPlaces);
  values(c.checksums, format::kChecksums);
  reader.expect_only(directory, "/directory", {}, kPath);
  return c;
}

/// Checks that each column has the required length, and that end offsets ascend to the end of the
/// divided column.
void check_columns(GroupReader& reader, const Columns& c, std::size_t n) {
  const auto expect = [&](const format::DatasetSpec& spec, std::size_t found, std::size_t a_model) {
    if (found != n * a_model) {
      reader.refuse(kPath + "/" + std::string(spec.name),
                    fmt::format("expected {}, found {} numbers", counted(n, "row"), found));
    }
  };
  expect(format::kTextEnds, c.text_ends.size(), 2);
  if (reader.version() >= format::kFingerprintsSince)
    expect(format::kFingerprints, c.fingerprints.size(), 2);
  expect(format::kDiameters, c.diameter.size(), 1);
  expect(format::kCenters, c.center.size(), 3);
  expect(format::kSpacings, c.spacing.size(), 1);
  expect(format::kAxes, c.axis.size(), 6);
  expect(format::kDeclared, c.declared.size(), 1);
  expect(format::kNearAxes, c.near_axis.size(), 6);
  expect(format::kMotionEnds, c.motion_ends.size(), 2);
  expect(format::kSteps, c.step.size(), 1);
  expect(format::kCounts, c.counts.size(), 3);
  expect(format::kResolutions, c.resolution.size(), kFeatureScales.size());
  expect(format::kPlaces, c.places.size(), 2 * kColumns);
  expect(format::kChecksums, c.checksums.size(), 2 * kColumns);
  const auto divide = [&](const format::DatasetSpec& spec, const std::vector<std::uint64_t>& ends,
                          std::size_t all) {
    if (!std::ranges::is_sorted(ends) || (ends.empty() ? 0 : ends.back()) != all)
      reader.refuse(kPath + "/" + std::string(spec.name),
                    fmt::format("expected to rise to {}", all));
  };
  divide(format::kTextEnds, c.text_ends, c.texts.size());
  divide(format::kMotionEnds, c.motion_ends, c.motions.size() / 16);
}

std::optional<Symmetry::Axis> axis_at(const std::vector<float>& axes, std::size_t m) {
  const Eigen::Vector3f direction(axes.data() + 6 * m), point(axes.data() + 6 * m + 3);
  if (direction == Eigen::Vector3f::Zero()) return std::nullopt;
  return Symmetry::Axis{direction, point};
}

ModelRecord record_at(const Columns& c, std::size_t m) {
  ModelRecord record;
  Model& model = record.traits;
  const std::string_view name(c.names.data() + m * format::kNameBytes, format::kNameBytes);
  model.name = name.substr(0, name.find('\0'));
  const auto text_to = [&](std::size_t end) {
    const std::uint64_t first = end == 0 ? 0 : c.text_ends[end - 1];
    return std::string(c.texts.data() + first, c.text_ends[end] - first);
  };
  model.source = text_to(2 * m);
  model.source_xxh3 = text_to(2 * m + 1);
  if (!c.fingerprints.empty()) {
    const Xxh3 fingerprint{c.fingerprints[2 * m], c.fingerprints[2 * m + 1]};
    if (fingerprint != Xxh3{}) model.fingerprint = fingerprint.hex();
  }
  model.diameter = c.diameter[m];
  model.center = Eigen::Vector3f(c.center.data() + 3 * m);
  model.sample_spacing = c.spacing[m];
  model.symmetry.declared = c.declared[m] != 0;
  model.symmetry.axis = axis_at(c.axis, m);
  const std::uint64_t first = m == 0 ? 0 : c.motion_ends[2 * m - 1];
  const std::uint64_t middle = c.motion_ends[2 * m], end = c.motion_ends[2 * m + 1];
  model.symmetry.poses = poses_of(std::span(c.motions).subspan(16 * first, 16 * (middle - first)));
  model.near_symmetries = poses_of(std::span(c.motions).subspan(16 * middle, 16 * (end - middle)));
  model.near_axis = axis_at(c.near_axis, m);
  model.ppf.quantization = {c.step[m], c.counts[3 * m + 1], c.counts[3 * m + 2]};
  model.ppf.num_references = c.counts[3 * m];
  for (std::size_t k = 0; k < kFeatureScales.size(); ++k)
    model.features[k].resolution = c.resolution[kFeatureScales.size() * m + k];
  for (std::size_t k = 0; k < kColumns; ++k) {
    const std::size_t at = 2 * (m * kColumns + k);
    record.columns[k] = {c.places[at], c.places[at + 1], {c.checksums[at], c.checksums[at + 1]}};
  }
  return record;
}

/// Checks that columns lie inside the file and consist of whole rows.
void check_places(GroupReader& reader, const ModelRecord& record, std::size_t num_components,
                  std::uint64_t file_bytes) {
  for (std::size_t k = 0; k < kColumns; ++k) {
    const StoredColumn& column = record.columns[k];
    const format::DatasetSpec& spec = format::kModelColumns[k].spec;
    const std::uint64_t row = format::row_bytes(spec, {.components = num_components});
    if (column.offset <= file_bytes && column.bytes <= file_bytes - column.offset &&
        (row == 0 ? column.bytes == 0 : column.bytes % row == 0))
      continue;
    reader.refuse(
        fmt::format("/models/{}/{}{}{}", record.traits.name, spec.group,
                    spec.group.empty() ? "" : "/", spec.name),
        fmt::format("expected whole rows of {} bytes inside the file of {}, found {} at {}", row,
                    file_bytes, column.bytes, column.offset));
  }
}

}  // namespace

std::vector<ModelRecord> read_directory(GroupReader& reader, const StoredGroup& directory,
                                        std::size_t num_components, std::uint64_t file_bytes) {
  const Columns columns = read_columns(reader, directory);
  const std::size_t n = columns.names.size() / format::kNameBytes;
  if (!reader.fault()) check_columns(reader, columns, n);
  if (reader.fault()) return {};
  std::vector<ModelRecord> records;
  for (std::size_t m = 0; m < n; ++m) {
    records.push_back(record_at(columns, m));
    check_places(reader, records.back(), num_components, file_bytes);
    if (m > 0 && records[m - 1].traits.name >= records[m].traits.name)
      reader.refuse(kPath + "/names", "expected names to rise");
    if (reader.fault()) return {};
  }
  return records;
}

}  // namespace trivet
