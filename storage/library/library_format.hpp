/// The names of the library format (docs/format.md), common to its writer and its reader.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "storage/library/stored_tree.hpp"
#include "storage/model.hpp"
#include "storage/result.hpp"

namespace trivet::format {

inline constexpr std::string_view kName = "trivet-library";
inline constexpr std::string_view kChecksum = "checksum";      ///< attribute of the root
inline constexpr std::string_view kDataChecksum = "xxh3_128";  ///< attribute of each dataset
inline constexpr std::uint64_t kRows = 0;  ///< stands in a shape for the number of rows
inline constexpr std::uint64_t kComponents = ~std::uint64_t{0};  ///< ... of principal components

/// One dataset of a model, or with the group "/trisi" of the library.
struct DatasetSpec {
  std::string_view group;  ///< empty: the model's own group
  std::string_view name;
  ElementType type;
  std::array<std::uint64_t, 3> shape;  ///< `rank` of them, one of which is kRows
  std::size_t rank;
  std::string_view long_name;
  std::string_view units;   ///< empty: the library's unit of length
  std::uint32_t since = 0;  ///< minor version that brought it
};

// Vectors lie as three columns: row 0 of (3, n) holds every x.
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

inline constexpr std::array kDatasets{
    kVertices,       kTriangles,       kSamples,       kSampleNormals, kSampleViews, kSymmetryPoses,
    kNearSymmetries, kNearAxis,        kPpfPoints,     kPpfNormals,    kPpfOffsets,  kPpfEntries,
    kMeanImage,      kImageComponents, kImageEnergies, kKeypoints,     kFrames,      kFeatures};

/// XXH3-128 over names, types, shapes and attributes of an object and of all below it, as in
/// docs/format.md; `children` are the digests of the objects in the group by name.
std::string digest(const StoredDataset& dataset);
std::string digest(const StoredAttributes& attributes,
                   const std::map<std::string, std::string>& children);
std::string digest(const StoredGroup& group);

/// Check what recognition relies on: lengths, index ranges, order, finite values, unit normals.
/// Linear in the size of the model. Errors: bad_data (names the model, the dataset and the row).
Result<void> check_model(const Model& model);

/// Likewise. Errors: bad_data (names the dataset and the row).
Result<void> check_basis(const TriSpinBasis& basis);

}  // namespace trivet::format
