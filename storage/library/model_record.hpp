/// What is known of a model before its columns are read.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "storage/data/model.hpp"
#include "storage/library/group_reader.hpp"
#include "storage/library/library_format.hpp"

namespace trivet {

struct ModelRecord {
  Model traits;  ///< without columns
  std::array<StoredColumn, format::kModelColumns.size()> columns{};
};

/// Take the records of all models from their groups, by name. Nothing of the large datasets is
/// read.
///
/// num_components  of the library's features; 0: it has none
std::vector<ModelRecord> read_models(GroupReader& reader, const StoredGroup& models,
                                     std::size_t num_components);

/// Take them from the directory. Extents are checked.
///
/// file_bytes  of the file that the columns lie in
std::vector<ModelRecord> read_directory(GroupReader& reader, const StoredGroup& directory,
                                        std::size_t num_components, std::uint64_t file_bytes);

/// Rigid motions of sixteen numbers each, row-major.
std::vector<Pose> poses_of(std::span<const float> numbers);

/// The columns of a level of the index, in the order of kLevelColumns.
inline constexpr std::array kLevelColumns{
    format::kLevelModels, format::kListCentroids, format::kListOffsets, format::kListCodes,
    format::kListModel,   format::kListKeypoints, format::kListFrames};
using LevelColumns = std::array<StoredColumn, kLevelColumns.size()>;

/// Views of the file. What lies in it at odd addresses is copied: small columns, since the writer
/// begins large ones on a page.
///
/// bytes  of the file, kept alive by the owner; all columns lie in it
Model map_model(const ModelRecord& record, std::span<const std::byte> bytes,
                const std::shared_ptr<const void>& owner, std::size_t num_components);
FeatureLevel map_level(float resolution, std::size_t stride, const LevelColumns& columns,
                       std::span<const std::byte> bytes, const std::shared_ptr<const void>& owner);

}  // namespace trivet
