/// The directory of a library's models, as columns.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "storage/library/model_record.hpp"
#include "storage/library/stored_tree.hpp"

namespace trivet {

/// The directory entry of a model whose datasets lie at the offsets in `described`.
ModelRecord record_of(const Model& model, const StoredGroup& described);

/// All models as columns: the datasets of /directory.
struct DirectoryColumns {
  std::string names, texts;
  std::vector<std::uint64_t> text_ends, fingerprints, motion_ends, places, checksums;
  std::vector<float> diameter, center, spacing, axis, near_axis, step, resolution;
  std::vector<Pose> motions;
  std::vector<std::uint8_t> declared;
  std::vector<std::uint32_t> counts;

  void add(const ModelRecord& record);
};

}  // namespace trivet
