/// The Tri-Spin-Images of a library's models, made ready to be matched.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "kernels/spin_images/code_index.hpp"
#include "storage/feature_index.hpp"
#include "storage/library.hpp"
#include "storage/result.hpp"
#include "storage/tri_spin_features.hpp"

namespace trivet::engine {

/// The index of a library whose file has none. Errors: bad_data (damaged).
Result<FeatureIndex> index_features(const Library& library);

/// Makes the levels of an index one after the other, each from the features of the models of one
/// resolution. Same bytes for any number of threads.
class FeatureIndexer {
 public:
  /// features  of all models; referred to
  explicit FeatureIndexer(std::span<const FeaturesOfModel> features);

  std::size_t num_levels() const noexcept { return levels_.size(); }
  /// By rising resolution. Takes some 150 bytes a feature of the level while it works.
  FeatureLevel level(std::size_t k) const;

 private:
  std::span<const FeaturesOfModel> features_;
  std::vector<std::vector<std::uint32_t>> levels_;  // which of the features
};

/// Add the index over the features of all models that a library is made of, after them. Errors: of
/// the writer.
Result<void> add_index(LibraryWriter& writer);

/// As kernels search it.
kernels::CodeIndexView code_index(const FeatureLevel& level) noexcept;

}  // namespace trivet::engine
