// Tri-Spin-Images, step by step, on one thread. The items of a row are keypoints or queries.
#include <algorithm>
#include <array>
#include <flann/flann.hpp>
#include <numeric>
#include <vector>

#include "descriptors/descriptors.hpp"
#include "engine/common/thread_limit.hpp"
#include "engine/hypotheses/search_codes.hpp"
#include "engine/libraries/build_code_lists.hpp"
#include "kernels/common/projector.hpp"
#include "kernels/spin_images/feature_codes.hpp"
#include "kernels/spin_images/tri_spin_image.hpp"
#include "spin_images/relief.hpp"
#include "support/reference_descriptor.hpp"

namespace trivet::bench {
namespace {

constexpr std::size_t kNumSupports = 200;

template <class Body>
benchmark::internal::Benchmark* add_row(const char* name, Body body) {
  const auto run = [body](benchmark::State& state) {
    const ThreadLimit one_thread(1);
    const std::size_t items = body(state);
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(items));
  };
  return benchmark::RegisterBenchmark(name, run)->Unit(benchmark::kMillisecond);
}

/// A row for each number of features that a query is compared with.
template <class Body>
benchmark::internal::Benchmark* add_query_row(const char* name, Body body) {
  return add_row(name, body)->Arg(64)->Arg(256)->Arg(1024);
}

/// The supports of some keypoints, with their frames.
struct Supports {
  std::vector<kernels::Support> supports;
  std::vector<kernels::LocalFrame> frames;
  float radius = relief().radius;
};

kernels::LocalFrame frame_of(const kernels::Support& support, std::size_t k) {
  kernels::LocalFrame frame =
      kernels::local_frame(support, relief().radius, relief().keypoint_normals[k]);
  kernels::aim_first_axis(support, relief().radius, frame);
  return frame;
}

const Supports& gathered() {
  static const Supports all = [] {
    Supports out;
    const kernels::VoxelHash grid(relief().points, 0.5F * out.radius);
    out.supports.resize(kNumSupports);
    for (std::size_t k = 0; k < kNumSupports; ++k) {
      kernels::gather_support(grid, relief().areas, relief().keypoints[k], out.radius,
                              out.supports[k]);
      out.frames.push_back(frame_of(out.supports[k], k));
    }
    return out;
  }();
  return all;
}

const auto* const kFrame = add_row("frame/ours", [](benchmark::State& state) {
  const Supports& all = gathered();
  double points = 0;
  for (const auto& support : all.supports) points += static_cast<double>(support.size);
  for (auto _ : state)
    for (std::size_t k = 0; k < kNumSupports; ++k)
      benchmark::DoNotOptimize(frame_of(all.supports[k], k));
  state.counters["points"] = points / kNumSupports;
  return kNumSupports;
});

const auto* const kNaiveFrame = add_row("frame/naive", [](benchmark::State& state) {
  const Supports& all = gathered();
  double worst = 0;
  for (auto _ : state) {
    for (std::size_t k = 0; k < kNumSupports; ++k) {
      const auto points = reference::points_of(all.supports[k]);
      const double radius = static_cast<double>(all.radius);
      Eigen::Matrix3d axes =
          reference::local_frame(points, radius, relief().keypoint_normals[k].cast<double>());
      const Eigen::Vector3d e3 = axes.row(2);
      axes.row(0) = reference::first_axis(points, radius, e3).first;
      axes.row(1) = e3.cross(Eigen::Vector3d(axes.row(0)));
      worst = std::max(worst, (axes - all.frames[k].axes.cast<double>()).norm());
    }
  }
  state.counters["worst_difference"] = worst;
  return kNumSupports;
});

const auto* const kImages = add_row("images/ours", [](benchmark::State& state) {
  const Supports& all = gathered();
  kernels::SpinScratch scratch;
  std::array<float, kernels::kSpinImageSize> image;
  for (auto _ : state) {
    for (std::size_t k = 0; k < kNumSupports; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        kernels::spin_image(all.supports[k], all.frames[k].axes.row(axis), all.radius, image,
                            scratch);
        kernels::normalize_spin_image(image);
        benchmark::DoNotOptimize(image);
      }
    }
  }
  return kNumSupports;
});

const auto* const kNaiveImages = add_row("images/naive", [](benchmark::State& state) {
  const Supports& all = gathered();
  for (auto _ : state) {
    for (std::size_t k = 0; k < kNumSupports / 10; ++k) {
      const auto points = reference::points_of(all.supports[k]);
      for (int axis = 0; axis < 3; ++axis)
        benchmark::DoNotOptimize(reference::spin_image(
            points, all.frames[k].axes.row(axis).cast<double>(), static_cast<double>(all.radius)));
    }
  }
  return kNumSupports / 10;
});

const auto* const kProject = add_row("project/ours", [](benchmark::State& state) {
  std::vector<float> features(kNumKeypoints * relief_basis().size());
  const kernels::Projector projector(relief_basis());
  for (auto _ : state) projector.project(relief_images(), features);
  return kNumKeypoints;
});

/// Features as numerous as those of a few models in a library, and of a scan: projected images of
/// all vertices of the relief and of the noisy keypoints.
struct Index {
  FeaturePool pool;
  std::vector<float> queries;
  std::vector<std::uint32_t> nearest;  // /< exact nearest neighbors
};

const Index& features() {
  static const Index index = [] {
    std::vector<std::uint32_t> vertices(relief().mesh.vertices.size());
    std::iota(vertices.begin(), vertices.end(), 0U);
    const KeypointSurface all = sample_surface(relief().mesh, vertices, 1);
    const PcaBasis& basis = relief_basis();
    Index out;
    out.pool.dimension = basis.size();
    out.pool.features.resize(vertices.size() * basis.size());
    const kernels::Projector projector(basis);
    projector.project(describe(descriptors().front(), all), out.pool.features);
    out.pool.models.assign(vertices.size(), 0);
    out.queries.resize(kNumKeypoints * basis.size());
    projector.project(noisy_images(), out.queries);
    std::vector<float> distances(kNumKeypoints * vertices.size());
    compare_all(out.queries, out.pool, distances);
    for (std::size_t q = 0; q < kNumKeypoints; ++q) {
      const auto row = std::span(distances).subspan(q * vertices.size(), vertices.size());
      out.nearest.push_back(
          static_cast<std::uint32_t>(std::ranges::min_element(row) - row.begin()));
    }
    return out;
  }();
  return index;
}

/// Adds the counter recall: the fraction of queries whose nearest feature was found.
template <class Found>
void report_recall(benchmark::State& state, const std::vector<Found>& found) {
  double right = 0;
  for (std::size_t q = 0; q < kNumKeypoints; ++q)
    right += static_cast<std::uint32_t>(found[q]) == features().nearest[q] ? 1 : 0;
  state.counters["recall"] = right / kNumKeypoints;
}

flann::Matrix<float> as_flann(std::span<const float> vectors) {
  const std::size_t d = features().pool.dimension;
  return {const_cast<float*>(vectors.data()), vectors.size() / d, d};  // only read
}

/// Vectors as codes with a stride. The quantization step covers the same range as the index.
Column<std::uint8_t> as_codes(std::span<const float> vectors) {
  const std::size_t d = features().pool.dimension;
  const float step = kernels::code_step_for(features().pool.features);
  Column<std::uint8_t> codes(vectors.size()), padded(vectors.size() / d * kernels::code_stride(d));
  kernels::encode(vectors, step, codes);
  kernels::pad_codes(codes, d, padded);
  return padded;
}

const auto* const kBuild = add_row("index_build/ours", [](benchmark::State& state) {
  const Column<std::uint8_t> codes = as_codes(features().pool.features);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        engine::build_code_lists(codes, kernels::code_stride(features().pool.dimension)));
  return features().pool.size();
});

const auto* const kFlannBuild = add_row("index_build/flann", [](benchmark::State& state) {
  for (auto _ : state) {
    flann::Index<flann::L2<float>> index(as_flann(features().pool.features),
                                         flann::KDTreeIndexParams(4));
    index.buildIndex();
  }
  return features().pool.size();
});

/// A row for each number of lists searched per query.
const auto* const kQuery =
    add_row("index_query/ours", [](benchmark::State& state) {
      const std::size_t stride = kernels::code_stride(features().pool.dimension);
      const Column<std::uint8_t> codes = as_codes(features().pool.features),
                                 queries = as_codes(features().queries);
      const engine::CodeLists lists = engine::build_code_lists(codes, stride);
      std::vector<std::uint32_t> order(lists.list.size());
      std::iota(order.begin(), order.end(), 0U);
      std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return lists.list[i]; });
      Column<std::uint8_t> in_order;
      for (const std::uint32_t i : order) {
        const auto code = std::span(codes).subspan(i * stride, stride);
        in_order.insert(in_order.end(), code.begin(), code.end());
      }
      const kernels::CodeIndexView index{stride, lists.centroids, lists.offsets, in_order};
      engine::CodeNeighbors nearest;
      for (auto _ : state)
        nearest = engine::search_codes(index, queries, static_cast<std::size_t>(state.range(0)), 1);
      std::vector<std::uint32_t> found;
      for (std::size_t q = 0; q < kNumKeypoints; ++q)
        found.push_back(order[nearest.of(q)[0].index]);
      report_recall(state, found);
      return kNumKeypoints;
    }) -> Arg(1) -> Arg(4) -> Arg(8);

const auto* const kFlannQuery = add_query_row("index_query/flann", [](benchmark::State& state) {
  flann::Index<flann::L2<float>> index(as_flann(features().pool.features),
                                       flann::KDTreeIndexParams(4));
  index.buildIndex();
  std::vector<int> found(kNumKeypoints);
  std::vector<float> distances(kNumKeypoints);
  flann::Matrix<int> indices(found.data(), kNumKeypoints, 1);
  flann::Matrix<float> out(distances.data(), kNumKeypoints, 1);
  flann::SearchParams params(static_cast<int>(state.range(0)));
  params.cores = 1;
  for (auto _ : state) index.knnSearch(as_flann(features().queries), indices, out, 1, params);
  report_recall(state, found);
  return kNumKeypoints;
});

const auto* const kExact = add_row("index_query/exact", [](benchmark::State& state) {
  std::vector<float> distances(kNumKeypoints * features().pool.size());
  for (auto _ : state) compare_all(features().queries, features().pool, distances);
  state.counters["recall"] = 1;
  return kNumKeypoints;
});

/// Supports, frames and images of all keypoints, including the construction of the search
/// structure; areas and normals are precomputed.
auto* add_descriptor_row(const char* name, const char* descriptor) {
  return add_row(name, [descriptor](benchmark::State& state) {
    const auto& all = descriptors();
    const auto used = std::ranges::find(all, descriptor, &Descriptor::name);
    Column<float> features;
    for (auto _ : state) features = describe(*used, relief());
    report_nearest_right(state, features, describe(*used, noisy_relief()));
    state.counters["numbers"] = static_cast<double>(used->size);
    return relief().keypoints.size();
  });
}

const auto* const kDescribe = add_descriptor_row("describe/ours_trisi", "TriSI");
const auto* const kDescribeSpin =
    add_descriptor_row("describe/ours_spin", "spin image, square roots");
#ifdef TRIVET_BENCH_PCL
const auto* const kDescribeRops = add_descriptor_row("describe/pcl_rops", "RoPS (PCL)");
#endif

}  // namespace
}  // namespace trivet::bench
