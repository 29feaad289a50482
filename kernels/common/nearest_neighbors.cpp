#include "kernels/common/nearest_neighbors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <flann/flann.hpp>
#include <limits>
#include <optional>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

using Tree = flann::KDTreeSingleIndex<flann::L2<float>>;

// FLANN drops points at exactly the given distance, and its bounds have rounding errors: search a
// little farther and let each result set decide exactly.
float a_little_more(float squared_distance) { return squared_distance * 1.00001F + FLT_MIN; }

// The k nearest so far, in the caller's row, sorted by distance, then index.
class NearestSet final : public flann::ResultSet<float> {
 public:
  NearestSet(std::span<std::uint32_t> indices, std::span<float> distances)
      : indices_(indices), distances_(distances) {
    std::ranges::fill(indices, NearestNeighbors::kNone);
    std::ranges::fill(distances, kInfinity);
  }
  bool full() const override { return indices_.back() != NearestNeighbors::kNone; }
  float worstDist() const override { return a_little_more(distances_.back()); }
  void addPoint(float distance, std::size_t found) override {
    const auto index = static_cast<std::uint32_t>(found);
    const auto before = [&](std::size_t at) {
      return distance < distances_[at] || (distance == distances_[at] && index < indices_[at]);
    };
    std::size_t at = indices_.size() - 1;
    if (!before(at)) return;
    for (; at > 0 && before(at - 1); --at) {
      indices_[at] = indices_[at - 1];
      distances_[at] = distances_[at - 1];
    }
    indices_[at] = index;
    distances_[at] = distance;
  }

 private:
  std::span<std::uint32_t> indices_;
  std::span<float> distances_;
};

// All points within a radius: counted, and stored as far as the caller's row allows.
class WithinSet final : public flann::ResultSet<float> {
 public:
  WithinSet(float radius, std::span<std::uint32_t> indices)
      : squared_radius_(radius >= 0 ? radius * radius : -1), indices_(indices) {}
  bool full() const override { return true; }
  float worstDist() const override { return a_little_more(squared_radius_); }
  void addPoint(float distance, std::size_t found) override {
    if (!(distance <= squared_radius_)) return;
    if (count_ < indices_.size()) indices_[count_] = static_cast<std::uint32_t>(found);
    ++count_;
  }
  std::uint32_t count() const { return count_; }

 private:
  float squared_radius_;
  std::span<std::uint32_t> indices_;
  std::uint32_t count_ = 0;
};

bool all_finite(std::span<const float> values) {
  return std::ranges::all_of(values, [](float value) { return std::isfinite(value); });
}

Column<float> interleave(PointsView points) {
  Column<float> vectors;
  vectors.reserve(3 * points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    vectors.insert(vectors.end(), {points.x[i], points.y[i], points.z[i]});
  }
  return vectors;
}

/// FLANN throws only for lack of memory in the functions used here.
Error out_of_memory(std::string_view task, const std::exception& reason) {
  return {ErrorCode::no_memory,
          fmt::format("cannot {} nearest neighbors: {} ({})", task, kOutOfMemory, reason.what())};
}

}  // namespace

struct NearestNeighbors::Index {
  Column<float> vectors;
  std::size_t dimension = 0, size = 0;
  std::optional<Tree> tree;  // empty without vectors

  // Offer the vectors near a query to a result set, until none can change the result.
  void search(std::span<const float> queries, std::size_t i, flann::ResultSet<float>& found) const {
    const std::span<const float> query = queries.subspan(i * dimension, dimension);
    if (tree && all_finite(query)) tree->findNeighbors(found, query.data(), flann::SearchParams());
  }
};

NearestNeighbors::NearestNeighbors(std::unique_ptr<Index> index) noexcept
    : index_(std::move(index)) {}
NearestNeighbors::NearestNeighbors(NearestNeighbors&&) noexcept = default;
NearestNeighbors& NearestNeighbors::operator=(NearestNeighbors&&) noexcept = default;
NearestNeighbors::~NearestNeighbors() = default;

std::size_t NearestNeighbors::size() const noexcept { return index_->size; }
std::size_t NearestNeighbors::dimension() const noexcept { return index_->dimension; }

Result<NearestNeighbors> NearestNeighbors::build(std::span<const float> vectors,
                                                 std::size_t dimension) {
  if (dimension == 0 || vectors.size() % dimension != 0) {
    return Error{ErrorCode::bad_data,
                 fmt::format("nearest neighbors: expected vectors of {} values each, found {} "
                             "values in all; pass whole vectors",
                             dimension, vectors.size())};
  }
  const auto bad = std::ranges::find_if_not(vectors, [](float v) { return std::isfinite(v); });
  if (bad != vectors.end()) {
    const auto at = static_cast<std::size_t>(bad - vectors.begin());
    return Error{ErrorCode::bad_data,
                 fmt::format("nearest neighbors: expected finite values, found {} in vector {}, "
                             "component {}; remove it first",
                             *bad, at / dimension, at % dimension)};
  }
  try {
    auto index = std::make_unique<Index>();
    index->vectors.assign(vectors.begin(), vectors.end());
    index->dimension = dimension;
    index->size = vectors.size() / dimension;
    if (index->size > 0) {
      const flann::Matrix<float> matrix(index->vectors.data(), index->size, dimension);
      index->tree.emplace(matrix, flann::KDTreeSingleIndexParams());
      index->tree->buildIndex();
    }
    return NearestNeighbors(std::move(index));
  } catch (const std::exception& reason) {
    return out_of_memory("index", reason);
  }
}

Result<NearestNeighbors> NearestNeighbors::build(PointsView points) {
  return build(interleave(points), 3);
}

Result<void> NearestNeighbors::k_nearest(std::span<const float> queries, std::size_t k,
                                         std::span<std::uint32_t> indices,
                                         std::span<float> squared_distances) const {
  const std::size_t num_queries = queries.size() / dimension();
  TRIVET_REQUIRE(indices.size() == num_queries * k, "k indices per query");
  TRIVET_REQUIRE(squared_distances.size() == num_queries * k, "k distances per query");
  if (k == 0) return {};
  try {
    for (std::size_t i = 0; i < num_queries; ++i) {
      NearestSet found(indices.subspan(i * k, k), squared_distances.subspan(i * k, k));
      index_->search(queries, i, found);
    }
    return {};
  } catch (const std::exception& reason) {
    return out_of_memory("find", reason);
  }
}

Result<void> NearestNeighbors::k_nearest(PointsView queries, std::size_t k,
                                         std::span<std::uint32_t> indices,
                                         std::span<float> squared_distances) const {
  TRIVET_REQUIRE(dimension() == 3, "points have three coordinates");
  return k_nearest(interleave(queries), k, indices, squared_distances);
}

Result<void> NearestNeighbors::count_within(std::span<const float> queries, float radius,
                                            std::span<std::uint32_t> counts) const {
  TRIVET_REQUIRE(counts.size() == queries.size() / dimension(), "one count per query");
  try {
    for (std::size_t i = 0; i < counts.size(); ++i) {
      WithinSet found(radius, {});
      index_->search(queries, i, found);
      counts[i] = found.count();
    }
    return {};
  } catch (const std::exception& reason) {
    return out_of_memory("count", reason);
  }
}

Result<void> NearestNeighbors::fill_within(std::span<const float> queries, float radius,
                                           std::span<const std::uint32_t> offsets,
                                           std::span<std::uint32_t> indices) const {
  TRIVET_REQUIRE(offsets.size() == queries.size() / dimension() + 1, "one row per query");
  try {
    for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
      const auto row = indices.subspan(offsets[i], offsets[i + 1] - offsets[i]);
      WithinSet found(radius, row);
      index_->search(queries, i, found);
      TRIVET_REQUIRE(found.count() == row.size(), "rows hold what was counted");
      std::ranges::sort(row);
    }
    return {};
  } catch (const std::exception& reason) {
    return out_of_memory("find", reason);
  }
}

}  // namespace trivet::kernels
