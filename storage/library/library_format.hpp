/// The names of the library format (docs/format.md), common to its writer and its reader.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "storage/common/result.hpp"
#include "storage/data/feature_index.hpp"
#include "storage/data/model.hpp"
#include "storage/library/stored_tree.hpp"

namespace trivet::format {

inline constexpr std::string_view kName = "trivet-library";
inline constexpr std::string_view kChecksum = "checksum";     ///< attribute of the root
inline constexpr std::string_view kColumnsIn = "columns_in";  ///< attribute of the root of contents
                                                              ///< files
inline constexpr std::string_view kDataChecksum = "xxh3_128";       ///< attribute of each dataset
inline constexpr std::string_view kModelsDigest = "models_digest";  ///< attribute of /directory
inline constexpr std::uint64_t kRows = 0;  ///< placeholder in a shape for the number of rows
inline constexpr std::uint64_t kComponents = ~std::uint64_t{0};  ///< placeholder for the number of
                                                                 ///< principal components
inline constexpr std::uint64_t kStride = ~std::uint64_t{1};      ///< placeholder for the bytes of a
                                                                 ///< code

/// A dataset of a model, or of the library if the group is "/trisi".
struct DatasetSpec {
  std::string_view group;  ///< empty: the model's own group
  std::string_view name;
  ElementType type;
  std::array<std::uint64_t, 3> shape;  ///< `rank` sizes, including kRows
  std::size_t rank;
  std::string_view long_name;
  std::string_view units;   ///< empty: the library's unit of length
  std::uint32_t since = 0;  ///< first minor version that has it
};

/// Library-dependent row sizes: the values of kComponents and kStride.
struct RowSizes {
  std::uint64_t components = 0;  ///< number of components of the library's features
  std::uint64_t stride = 0;      ///< bytes of a code in a level of the index
};

/// The shape of a dataset in a library of these sizes.
std::array<std::uint64_t, 3> shape_of(const DatasetSpec& spec, const RowSizes& sizes) noexcept;
/// The size of a row of the dataset.
std::uint64_t row_bytes(const DatasetSpec& spec, const RowSizes& sizes) noexcept;

// Vectors are stored as three columns: row 0 of (3, n) holds every x.
inline constexpr DatasetSpec kVertices{
    "", "vertices", ElementType::f32, {3, kRows}, 2, "surface vertices, rows x, y, z", ""};
inline constexpr DatasetSpec kTriangles{
    "",         "triangles", ElementType::u32,
    {3, kRows}, 2,           "vertex indices of the triangles' corners, rows a, b, c",
    "1"};
inline constexpr DatasetSpec kSamples{
    "", "samples", ElementType::f32, {3, kRows}, 2, "samples of the visible surface, rows x, y, z",
    ""};
inline constexpr DatasetSpec kSampleNormals{"",
                                            "sample_normals",
                                            ElementType::f32,
                                            {3, kRows},
                                            2,
                                            "outward unit normals of the samples, rows x, y, z",
                                            "1"};
inline constexpr DatasetSpec kSampleViews{"",
                                          "sample_views",
                                          ElementType::u64,
                                          {kRows, kViewWords},
                                          2,
                                          "directions that see the sample, one bit each",
                                          "1"};
inline constexpr DatasetSpec kSymmetryPoses{
    "",
    "symmetry_poses",
    ElementType::f32,
    {kRows, 4, 4},
    3,
    "motions that map the model onto itself, 4x4 row-major; "
    "translations in the unit of length",
    "1"};
inline constexpr DatasetSpec kNearSymmetries{
    "",
    "near_symmetries",
    ElementType::f32,
    {kRows, 4, 4},
    3,
    "motions that map much of the model onto itself, best first, 4x4 row-major; "
    "translations in the unit of length",
    "1",
    1};
inline constexpr DatasetSpec kNearAxis{
    "",
    "near_axis",
    ElementType::f32,
    {kRows, 2, 3},
    3,
    "unit direction and a point of the axis about which any turn looks alike, if there is one",
    "",
    2};
inline constexpr DatasetSpec kPpfPoints{
    "ppf", "points", ElementType::f32, {3, kRows}, 2, "points of the pair table, rows x, y, z", ""};
inline constexpr DatasetSpec kPpfNormals{
    "ppf", "normals", ElementType::f32, {3, kRows}, 2, "unit normals of those points, rows x, y, z",
    "1"};
inline constexpr DatasetSpec kPpfOffsets{
    "ppf", "offsets", ElementType::u32, {kRows}, 1, "first entry of each cell of the pair feature",
    "1"};
inline constexpr DatasetSpec kPpfEntries{
    "ppf",      "entries", ElementType::u16,
    {kRows, 2}, 2,         "reference point and rotation angle, 65536 = a full turn",
    "1"};
inline constexpr std::uint64_t kImageSize = 675;
inline constexpr DatasetSpec kMeanImage{
    "/trisi", "mean", ElementType::f32, {kImageSize}, 1, "mean of the Tri-Spin-Images", "1", 3};
inline constexpr DatasetSpec kImageComponents{"/trisi",
                                              "components",
                                              ElementType::f32,
                                              {kRows, kImageSize},
                                              2,
                                              "principal components, orthogonal unit rows",
                                              "1",
                                              3};
inline constexpr DatasetSpec kImageEnergies{
    "/trisi", "energies", ElementType::f32, {kRows}, 1, "variance along each component", "1", 3};
inline constexpr DatasetSpec kKeypoints{
    "trisi", "keypoints", ElementType::f32, {3, kRows}, 2, "keypoints, rows x, y, z", "", 3};
inline constexpr DatasetSpec kFrames{
    "trisi",       "frames", ElementType::f32,
    {kRows, 3, 3}, 3,        "local reference frames, rows e1, e2, e3",
    "1",           3};
inline constexpr DatasetSpec kFeatures{"trisi",
                                       "features",
                                       ElementType::u8,
                                       {kRows, kComponents},
                                       2,
                                       "Tri-Spin-Images in the principal components, coded",
                                       "1",
                                       3};

/// Groups of a model's features by scale.
inline constexpr std::array<std::string_view, kFeatureScales.size()> kFeatureGroups{
    "trisi", "trisi_2x", "trisi_4x"};
constexpr DatasetSpec at_scale(DatasetSpec spec, std::size_t k) {
  if (k > 0) spec.since = 4;
  spec.group = kFeatureGroups[k];
  return spec;
}

/// The columns of a model that may be large, each with the part it belongs to.
struct ModelColumn {
  DatasetSpec spec;
  ModelPart part;
};
inline constexpr std::array kModelColumns{ModelColumn{kVertices, ModelPart::surface},
                                          ModelColumn{kTriangles, ModelPart::surface},
                                          ModelColumn{kSamples, ModelPart::samples},
                                          ModelColumn{kSampleNormals, ModelPart::samples},
                                          ModelColumn{kSampleViews, ModelPart::samples},
                                          ModelColumn{kPpfPoints, ModelPart::pairs},
                                          ModelColumn{kPpfNormals, ModelPart::pairs},
                                          ModelColumn{kPpfOffsets, ModelPart::pairs},
                                          ModelColumn{kPpfEntries, ModelPart::pairs},
                                          ModelColumn{kKeypoints, ModelPart::features},
                                          ModelColumn{kFrames, ModelPart::features},
                                          ModelColumn{kFeatures, ModelPart::features},
                                          ModelColumn{at_scale(kKeypoints, 1), ModelPart::features},
                                          ModelColumn{at_scale(kFrames, 1), ModelPart::features},
                                          ModelColumn{at_scale(kFeatures, 1), ModelPart::features},
                                          ModelColumn{at_scale(kKeypoints, 2), ModelPart::features},
                                          ModelColumn{at_scale(kFrames, 2), ModelPart::features},
                                          ModelColumn{at_scale(kFeatures, 2), ModelPart::features}};

// Metadata of all models, needed to open a library: one row per model in the order of names.
inline constexpr std::uint32_t kDirectorySince = 4;
inline constexpr std::uint64_t kNameBytes = 128;
constexpr DatasetSpec of_directory(std::string_view name, ElementType type,
                                   std::array<std::uint64_t, 3> shape, std::size_t rank,
                                   std::string_view long_name, std::string_view units = "1") {
  return {"/directory", name, type, shape, rank, long_name, units, kDirectorySince};
}
inline constexpr DatasetSpec kNames = of_directory("names", ElementType::u8, {kRows, kNameBytes}, 2,
                                                   "names of the models, filled up with NUL");
inline constexpr DatasetSpec kTexts =
    of_directory("texts", ElementType::u8, {kRows}, 1,
                 "source and source_xxh3 of each model, one after the other");
inline constexpr DatasetSpec kTextEnds = of_directory("text_ends", ElementType::u64, {kRows, 2}, 2,
                                                      "where both texts of each model end");
inline constexpr std::uint32_t kFingerprintsSince = 5;
inline constexpr DatasetSpec kFingerprints{
    "/directory",
    "fingerprints",
    ElementType::u64,
    {kRows, 2},
    2,
    "of all that each model was trained from, high half first",
    "1",
    kFingerprintsSince};
inline constexpr DatasetSpec kDiameters = of_directory("diameter", ElementType::f32, {kRows}, 1,
                                                       "largest distance of surface points", "");
inline constexpr DatasetSpec kCenters =
    of_directory("centre", ElementType::f32, {kRows, 3}, 2, "mean of the samples", "");
inline constexpr DatasetSpec kSpacings = of_directory("sample_spacing", ElementType::f32, {kRows},
                                                      1, "distance of neighboring samples", "");
inline constexpr DatasetSpec kAxes =
    of_directory("symmetry_axis", ElementType::f32, {kRows, 2, 3}, 3,
                 "unit direction and a point; zeros where there is no axis", "");
inline constexpr DatasetSpec kDeclared =
    of_directory("symmetry_declared", ElementType::u8, {kRows}, 1, "1: given by the user");
inline constexpr DatasetSpec kNearAxes =
    of_directory("near_axis", ElementType::f32, {kRows, 2, 3}, 3,
                 "unit direction and a point; zeros where there is no axis", "");
inline constexpr DatasetSpec kMotions =
    of_directory("motions", ElementType::f32, {kRows, 4, 4}, 3,
                 "symmetry_poses and near_symmetries of each model, one after the other");
inline constexpr DatasetSpec kMotionEnds =
    of_directory("motion_ends", ElementType::u64, {kRows, 2}, 2,
                 "where both kinds of motions of each model end");
inline constexpr DatasetSpec kSteps = of_directory("distance_step", ElementType::f32, {kRows}, 1,
                                                   "width of a distance bin of the pairs", "");
inline constexpr DatasetSpec kCounts =
    of_directory("pair_counts", ElementType::u32, {kRows, 3}, 2,
                 "num_references, num_distance_bins and num_angle_bins of the pairs");
inline constexpr DatasetSpec kResolutions =
    of_directory("resolution", ElementType::f32, {kRows, kFeatureScales.size()}, 2,
                 "of the Tri-Spin-Images by scale", "");
inline constexpr DatasetSpec kPlaces =
    of_directory("places", ElementType::u64, {kRows, kModelColumns.size(), 2}, 3,
                 "offset in this file and bytes of each large dataset");
inline constexpr DatasetSpec kChecksums =
    of_directory("checksums", ElementType::u64, {kRows, kModelColumns.size(), 2}, 3,
                 "XXH3-128 of each large dataset, high half first");

// One resolution of the index over all features: /index/NN.
constexpr DatasetSpec of_index(std::string_view name, ElementType type,
                               std::array<std::uint64_t, 3> shape, std::size_t rank,
                               std::string_view long_name, std::string_view units = "1") {
  return {"/index", name, type, shape, rank, long_name, units, kDirectorySince};
}
inline constexpr DatasetSpec kLevelModels =
    of_index("models", ElementType::u32, {kRows}, 1, "models that have features");
inline constexpr DatasetSpec kListCentroids =
    of_index("centroids", ElementType::u8, {kRows, kStride}, 2, "of each list");
inline constexpr DatasetSpec kListOffsets =
    of_index("offsets", ElementType::u32, {kRows}, 1, "where each list begins, and the end");
inline constexpr DatasetSpec kListCodes =
    of_index("codes", ElementType::u8, {kRows, kStride}, 2, "features, list by list");
inline constexpr DatasetSpec kListModel =
    of_index("model", ElementType::u32, {kRows}, 1, "model of each feature");
inline constexpr DatasetSpec kListKeypoints =
    of_index("keypoints", ElementType::f32, {3, kRows}, 2, "keypoints, rows x, y, z", "");
inline constexpr DatasetSpec kListFrames =
    of_index("frames", ElementType::u16, {kRows, 4}, 2,
             "local reference frames as quaternions (w, x, y, z): q = code / 32767 - 1");

inline constexpr std::array kDatasets{kVertices,
                                      kTriangles,
                                      kSamples,
                                      kSampleNormals,
                                      kSampleViews,
                                      kSymmetryPoses,
                                      kNearSymmetries,
                                      kNearAxis,
                                      kPpfPoints,
                                      kPpfNormals,
                                      kPpfOffsets,
                                      kPpfEntries,
                                      kMeanImage,
                                      kImageComponents,
                                      kImageEnergies,
                                      kKeypoints,
                                      kFrames,
                                      kFeatures,
                                      at_scale(kKeypoints, 1),
                                      at_scale(kFrames, 1),
                                      at_scale(kFeatures, 1),
                                      at_scale(kKeypoints, 2),
                                      at_scale(kFrames, 2),
                                      at_scale(kFeatures, 2),
                                      kNames,
                                      kTexts,
                                      kTextEnds,
                                      kFingerprints,
                                      kDiameters,
                                      kCenters,
                                      kSpacings,
                                      kAxes,
                                      kDeclared,
                                      kNearAxes,
                                      kMotions,
                                      kMotionEnds,
                                      kSteps,
                                      kCounts,
                                      kResolutions,
                                      kPlaces,
                                      kChecksums,
                                      kLevelModels,
                                      kListCentroids,
                                      kListOffsets,
                                      kListCodes,
                                      kListModel,
                                      kListKeypoints,
                                      kListFrames};

/// XXH3-128 over names, types, shapes and attributes of an object and all its descendants, as in
/// docs/format.md; `children` are the digests of the objects in the group by name.
std::string digest(const StoredDataset& dataset);
std::string digest(const StoredAttributes& attributes,
                   const std::map<std::string, std::string>& children);
std::string digest(const StoredGroup& group);

/// Check the invariants that recognition relies on: lengths, index ranges, order, finite values,
/// unit normals. Linear in the size of the model. Errors: bad_data (names the model, the dataset
/// and the row).
Result<void> check_model(const Model& model);
/// Subsets of check_model: the metadata checked on opening, and one part of the columns.
Result<void> check_traits(const Model& model);
/// name  of the model, for errors
Result<void> check_part(std::string_view name, const ModelColumns& columns, ModelPart part);

/// Check the basis of a library. Errors: bad_data (names the dataset and the row).
Result<void> check_basis(const TriSpinBasis& basis);
/// num_models  number of models in the library
Result<void> check_level(const FeatureLevel& level, std::size_t num_models);
/// Subsets of check_level: the columns stored once, and a range of the features.
Result<void> check_lists(const FeatureLevel& level, std::size_t num_models);
Result<void> check_listed(std::span<const std::uint32_t> model, PointsView keypoints,
                          std::size_t num_models);

}  // namespace trivet::format
