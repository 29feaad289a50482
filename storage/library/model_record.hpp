/// Metadata of a model, known before its columns are read.
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
  Model traits;  ///< model without columns
  std::array<StoredColumn, format::kModelColumns.size()> columns{};
};

/// Read the records of all models from their groups, by name. Large datasets are not read.
///
/// num_components  size of the library's basis; 0: it has none
std::vector<ModelRecord> read_models(GroupReader& reader, const StoredGroup& models,
                                     std::size_t num_components);

/// Read the records from the directory. Extents are checked.
///
/// file_bytes  size of the file with the columns
std::vector<ModelRecord> read_directory(GroupReader& reader, const StoredGroup& directory,
                                        std::size_t num_components, std::uint64_t file_bytes);

/// Rigid transforms from sixteen numbers each, row-major.
std::vector<Pose> poses_of(std::span<const float> numbers);

/// The columns of a level of the index, in the order of kLevelColumns.
inline constexpr std::array kLevelColumns{
    format::kLevelModels, format::kListCentroids, format::kListOffsets, format::kListCodes,
    format::kListModel,   format::kListKeypoints, format::kListFrames};
using LevelColumns = std::array<StoredColumn, kLevelColumns.size()>;

/// A model whose columns are views of the file. Misaligned columns are copied; they are small,
/// since the writer page-aligns large ones.
///
/// bytes  bytes of the file, kept alive by the owner; all columns lie in them
Model map_model(const ModelRecord& record, std::span<const std::byte> bytes,
                const std::shared_ptr<const void>& owner, std::size_t num_components);
FeatureLevel map_level(float resolution, std::size_t stride, const LevelColumns& columns,
                       std::span<const std::byte> bytes, const std::shared_ptr<const void>& owner);

}  // namespace trivet
