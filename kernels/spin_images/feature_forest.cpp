#include "kernels/spin_images/feature_forest.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <numeric>

#include "kernels/common/counter_random.hpp"
#include "storage/simd.hpp"

namespace trivet::kernels {
namespace {

constexpr std::size_t kLanes = 16;
constexpr std::uint32_t kLeaf = 12;    // vectors of a leaf, at most
constexpr std::size_t kLikely = 5;     // coordinates of which one is split
constexpr std::size_t kSampled = 100;  // vectors that tell which vary most
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Sixteen partial sums, added up in one order on any processor.
TRIVET_SIMD_CLONES
void compare(const float* __restrict query, const float* __restrict vectors, std::size_t stride,
             const std::uint32_t* __restrict members, std::size_t count,
             float* __restrict distances) noexcept {
  for (std::size_t m = 0; m < count; ++m) {
    const float* const vector = vectors + members[m] * stride;
    alignas(64) std::array<float, kLanes> sums{};
    for (std::size_t i = 0; i < stride; i += kLanes) {
      for (std::size_t k = 0; k < kLanes; ++k) {
        const float d = query[i + k] - vector[i + k];
        sums[k] += d * d;
      }
    }
    for (std::size_t half = kLanes / 2; half > 0; half /= 2) {
      for (std::size_t k = 0; k < half; ++k) sums[k] += sums[k + half];
    }
    distances[m] = sums[0];
  }
}

bool farther(const FeatureForest::Scratch::Branch& a,
             const FeatureForest::Scratch::Branch& b) noexcept {
  if (a.rank != b.rank) return a.rank > b.rank;
  return a.tree != b.tree ? a.tree > b.tree : a.node > b.node;
}

}  // namespace

class FeatureForest::Builder {
 public:
  Builder(const FeatureForest& forest, std::uint32_t tree, Tree& out)
      : forest_(forest), random_(tree, 0, 0), tree_(out) {
    tree_.order.resize(forest.size_);
    std::iota(tree_.order.begin(), tree_.order.end(), 0U);
    tree_.nodes.emplace_back();
    split(0, 0, static_cast<std::uint32_t>(forest.size_));
  }

 private:
  void split(std::uint32_t node, std::uint32_t first, std::uint32_t last) {
    if (last - first > kLeaf) {
      const auto [axis, mean] = choose_split(first, last);
      const auto begin = tree_.order.begin() + first, end = tree_.order.begin() + last;
      const auto middle =
          std::stable_partition(begin, end, [&, axis = axis, mean = mean](std::uint32_t i) {
            return forest_.vector(i)[axis] < mean;
          });
      if (middle != begin && middle != end) {
        const auto half = static_cast<std::uint32_t>(middle - tree_.order.begin());
        const auto left = static_cast<std::uint32_t>(tree_.nodes.size());
        tree_.nodes.resize(left + 2);
        tree_.nodes[node] = {left, axis, mean, 0};
        split(left, first, half);
        split(left + 1, half, last);
        return;
      }
    }
    tree_.nodes[node] = {0, first, 0, last - first};  // few, or all alike
  }

  /// One of the coordinates that vary most, and its mean.
  std::pair<std::uint32_t, float> choose_split(std::uint32_t first, std::uint32_t last) {
    const std::size_t d = forest_.dimension_, n = std::min<std::size_t>(kSampled, last - first);
    means_.assign(d, 0);
    squares_.assign(d, 0);
    for (std::size_t k = 0; k < n; ++k) {
      const auto at = static_cast<std::ptrdiff_t>(first + k * (last - first) / n);
      const float* const v = forest_.vector(tree_.order.begin()[at]);
      for (std::size_t c = 0; c < d; ++c) {
        means_[c] += static_cast<double>(v[c]);
        squares_[c] += static_cast<double>(v[c]) * static_cast<double>(v[c]);
      }
    }
    axes_.resize(d);
    std::iota(axes_.begin(), axes_.end(), 0U);
    const auto variance = [&](std::uint32_t c) {
      return squares_[c] - means_[c] * means_[c] / static_cast<double>(n);
    };
    const std::size_t likely = std::min(kLikely, d);
    std::partial_sort(axes_.begin(), axes_.begin() + static_cast<std::ptrdiff_t>(likely),
                      axes_.end(), [&](std::uint32_t a, std::uint32_t b) {
                        const double va = variance(a), vb = variance(b);
                        return va != vb ? va > vb : a < b;
                      });
    const std::uint32_t axis = axes_[random_.next() % likely];
    return {axis, static_cast<float>(means_[axis] / static_cast<double>(n))};
  }

  const FeatureForest& forest_;
  CounterRandom random_;
  Tree& tree_;
  std::vector<double> means_, squares_;
  std::vector<std::uint32_t> axes_;
};

FeatureForest::FeatureForest(std::span<const float> vectors, std::size_t dimension,
                             std::uint32_t num_trees)
    : dimension_(dimension),
      stride_((dimension + kLanes - 1) / kLanes * kLanes),
      size_(vectors.size() / dimension),
      vectors_(size_ * stride_, 0.0F),
      trees_(num_trees) {
  assert(dimension > 0 && vectors.size() % dimension == 0 && num_trees > 0);
  for (std::size_t i = 0; i < size_; ++i)
    std::copy_n(vectors.data() + i * dimension, dimension, vectors_.data() + i * stride_);
  for (std::uint32_t t = 0; t < num_trees; ++t) Builder(*this, t, trees_[t]);
}

void FeatureForest::k_nearest(std::span<const float> queries, std::size_t k, std::size_t max_checks,
                              std::span<std::uint32_t> indices, std::span<float> squared_distances,
                              Scratch& scratch) const {
  if (k == 0 || dimension_ == 0) return;
  const std::size_t num_queries = queries.size() / dimension_;
  assert(indices.size() == num_queries * k && squared_distances.size() == num_queries * k);
  std::ranges::fill(indices, kNone);
  std::ranges::fill(squared_distances, kInfinity);
  if (size_ == 0) return;
  scratch.query.assign(stride_, 0.0F);
  for (std::size_t q = 0; q < num_queries; ++q) {
    const auto best = indices.subspan(q * k, k);
    const auto distances = squared_distances.subspan(q * k, k);
    std::copy_n(queries.data() + q * dimension_, dimension_, scratch.query.data());
    const auto insert = [&](std::uint32_t index, float distance) {
      const auto before = [&](std::size_t at) {
        return distance < distances[at] || (distance == distances[at] && index < best[at]);
      };
      if (!before(k - 1)) return;
      for (std::size_t at = 0; at < k; ++at) {
        if (best[at] == index) return;  // another tree found it
      }
      std::size_t at = k - 1;
      for (; at > 0 && before(at - 1); --at) {
        best[at] = best[at - 1];
        distances[at] = distances[at - 1];
      }
      best[at] = index;
      distances[at] = distance;
    };

    scratch.branches.clear();
    std::size_t checks = 0;
    const auto descend = [&](Scratch::Branch branch) {
      const Tree& tree = trees_[branch.tree];
      while (tree.nodes[branch.node].left != 0) {
        const Node& node = tree.nodes[branch.node];
        const float off = scratch.query[node.axis] - node.split;
        const std::uint32_t near = node.left + (off < 0 ? 0 : 1),
                            far = node.left + (off < 0 ? 1 : 0);
        scratch.branches.push_back(
            {branch.rank + off * off, std::max(branch.bound, off * off), branch.tree, far});
        std::push_heap(scratch.branches.begin(), scratch.branches.end(), farther);
        branch.node = near;
      }
      const Node& leaf = tree.nodes[branch.node];
      if (scratch.distances.size() < leaf.count) scratch.distances.resize(leaf.count);
      compare(scratch.query.data(), vectors_.data(), stride_, tree.order.data() + leaf.axis,
              leaf.count, scratch.distances.data());
      for (std::uint32_t m = 0; m < leaf.count; ++m)
        insert(tree.order[leaf.axis + m], scratch.distances[m]);
      checks += leaf.count;
    };
    for (std::uint32_t t = 0; t < trees_.size(); ++t) descend({0, 0, t, 0});
    while (!scratch.branches.empty() && checks < max_checks) {
      std::pop_heap(scratch.branches.begin(), scratch.branches.end(), farther);
      const Scratch::Branch branch = scratch.branches.back();
      scratch.branches.pop_back();
      if (branch.bound <= distances[k - 1]) descend(branch);
    }
  }
}

}  // namespace trivet::kernels
