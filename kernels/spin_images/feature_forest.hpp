/// Approximate nearest neighbors among feature vectors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "storage/columns.hpp"

namespace trivet::kernels {

/// Randomized k-d trees that are searched together, best bin first.
///
/// Every tree splits at the mean of a coordinate drawn from the five that vary most. Unlike FLANN's
/// forest, whose trees come from std::random_device, the same vectors give the same trees. Only
/// reads once it is built: searches may run side by side.
/// Source: Silpa-Anan and Hartley, CVPR 2008; Muja and Lowe, VISAPP 2009.
class FeatureForest {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  /// Working memory of a search.
  struct Scratch {
    struct Branch {
      float rank;   ///< sum of the squared distances to the splits above: lower is likelier
      float bound;  ///< the largest of them: what lies below is no nearer
      std::uint32_t tree, node;
    };
    std::vector<Branch> branches;  ///< a heap
    Column<float> query, distances;
  };

  FeatureForest() = default;

  /// Build over n vectors, n < 2^31 - 1. Keeps a copy of them.
  ///
  /// vectors    n of `dimension` > 0 finite numbers, one after the other
  /// num_trees  > 0
  FeatureForest(std::span<const float> vectors, std::size_t dimension, std::uint32_t num_trees = 4);

  std::size_t size() const noexcept { return size_; }
  std::size_t dimension() const noexcept { return dimension_; }

  /// Write the k nearest of the vectors that each query is compared with, the nearest first; of
  /// equally near ones the lowest index.
  ///
  /// queries            m vectors of finite numbers
  /// max_checks         vectors that a query is compared with, about: more are more exact; from
  ///                    num_trees * size() on all are exact
  /// indices            m * k; kNone past the last neighbor
  /// squared_distances  m * k; infinite past the last neighbor
  /// Queries are independent: any split into chunks gives the same bits, on any processor. The
  /// scratch grows once.
  void k_nearest(std::span<const float> queries, std::size_t k, std::size_t max_checks,
                 std::span<std::uint32_t> indices, std::span<float> squared_distances,
                 Scratch& scratch) const;

 private:
  struct Node {
    std::uint32_t left = 0;  ///< the right child follows it; 0: a leaf
    std::uint32_t axis = 0;  ///< that is split; of a leaf: its first entry
    float split = 0;
    std::uint32_t count = 0;  ///< entries of a leaf
  };
  struct Tree {
    std::vector<Node> nodes;
    Column<std::uint32_t> order;  ///< of the vectors: leaves hold runs of it
  };
  class Builder;

  const float* vector(std::uint32_t i) const noexcept { return vectors_.data() + i * stride_; }

  std::size_t dimension_ = 0, stride_ = 0, size_ = 0;
  Column<float> vectors_;  // padded with zeros to whole lanes
  std::vector<Tree> trees_;
};

}  // namespace trivet::kernels
