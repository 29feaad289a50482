#include "engine/libraries/index_features.hpp"

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/common/parallel.hpp"
#include "engine/libraries/build_code_lists.hpp"
#include "kernels/spin_images/rotation_code.hpp"
#include "storage/files/file.hpp"

namespace trivet::engine {
namespace {

/// The features of one resolution, model after model. They are read from the mapped file a part at
/// a time, and their pages are released.
class LevelFeatures {
 public:
  /// level  levels of the models' features to use; at least one, none of them empty
  LevelFeatures(const WrittenFeatures& all, std::span<const std::uint32_t> level)
      : mapped_(all.mapped) {
    for (const std::uint32_t i : level) {
      of_models_.push_back(&all.of_models[i]);
      begins_.push_back(begins_.back() + of_models_.back()->features.size());
    }
  }

  std::size_t size() const noexcept { return begins_.back(); }
  std::size_t stride() const noexcept { return kernels::code_stride(num_components()); }
  float resolution() const noexcept { return of_models_.front()->features.resolution; }
  /// Models with features, rising.
  Column<std::uint32_t> models() const {
    Column<std::uint32_t> out;
    for (const FeaturesOfModel* one : of_models_) out.push_back(one->model);
    return out;
  }

  /// Write the codes from `first` on, padded.
  void read_codes(std::size_t first, std::span<std::uint8_t> codes) const {
    for (std::size_t p = place_of(first); !codes.empty(); ++p) {
      const std::size_t row = first - begins_[p];
      const std::size_t count = std::min(begins_[p + 1] - first, codes.size() / stride());
      const auto own =
          of_models_[p]->features.codes.subspan(row * num_components(), count * num_components());
      ask_for_pages(std::as_bytes(own));
      kernels::pad_codes(own, num_components(), codes.first(count * stride()));
      release(own);
      codes = codes.subspan(count * stride());
      first += count;
    }
  }

  /// Write some features to rows.
  ///
  /// which  features, rising
  /// to     row of each feature
  void copy(std::span<const std::uint32_t> which, std::span<const std::uint32_t> to,
            const ListedFeaturesSpan& rows) const {
    for_each_index(of_models_.size(), [&](std::size_t p) {
      const auto at = [&](std::size_t begin) {
        return static_cast<std::size_t>(std::ranges::lower_bound(which, begin) - which.begin());
      };
      const std::size_t first = at(begins_[p]), last = at(begins_[p + 1]);
      if (first == last) return;
      const TriSpinFeatures& own = of_models_[p]->features;
      for (std::size_t i = first; i < last; ++i) {
        const std::size_t row = which[i] - begins_[p];
        rows.model[to[i]] = of_models_[p]->model;
        rows.keypoints.set(to[i], own.keypoints[row]);
        rows.frames[to[i]] = kernels::encode_rotation(
            Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(own.frames[row].data()));
        kernels::pad_codes(own.codes.subspan(row * num_components(), num_components()),
                           num_components(), rows.codes.subspan(to[i] * stride(), stride()));
      }
      release(own.codes);
      release<FrameRows>(own.frames);
      for (const auto column : {own.keypoints.x, own.keypoints.y, own.keypoints.z}) release(column);
    });
  }

 private:
  std::size_t num_components() const noexcept {
    return of_models_.front()->features.num_components;
  }
  std::size_t place_of(std::size_t feature) const {
    return static_cast<std::size_t>(std::ranges::upper_bound(begins_, feature) - begins_.begin()) -
           1;
  }
  template <class T>
  void release(std::span<const T> read) const noexcept {
    release_pages_around(std::as_bytes(read), mapped_);
  }

  std::span<const std::byte> mapped_;
  std::vector<const FeaturesOfModel*> of_models_;
  std::vector<std::size_t> begins_{0};  // start of each model, and the end
};

/// A level and the source of its features.
class LevelMaker {
 public:
  LevelMaker(const WrittenFeatures& all, std::span<const std::uint32_t> level)
      : features_(all, level),
        lists_(build_code_lists({features_.size(), features_.stride(),
                                 [this](std::size_t first, std::span<std::uint8_t> codes) {
                                   features_.read_codes(first, codes);
                                 }})) {}
  LevelMaker(const LevelMaker&) = delete;
  LevelMaker& operator=(const LevelMaker&) = delete;

  /// Level without its features.
  FeatureLevel level() const {
    FeatureLevel out;
    out.resolution = features_.resolution();
    out.stride = features_.stride();
    out.models = features_.models();
    out.centroids = lists_.centroids;
    out.offsets = lists_.offsets;
    return out;
  }

  void list(std::size_t first, const ListedFeaturesSpan& rows) const {
    // Features of the lists that overlap the piece, in feature order, so that those of a model are
    // read together.
    const auto list_of = [&](std::size_t row) {
      return static_cast<std::uint32_t>(std::ranges::upper_bound(lists_.offsets, row) -
                                        lists_.offsets.begin() - 1);
    };
    const std::size_t end = first + rows.size();
    const std::uint32_t first_list = list_of(first), last_list = list_of(end - 1);
    std::vector<std::uint32_t> next(lists_.offsets.begin() + first_list,
                                    lists_.offsets.begin() + last_list + 1);
    std::vector<std::uint32_t> which, to;
    which.reserve(rows.size());
    to.reserve(rows.size());
    for (std::uint32_t i = 0; i < lists_.list.size(); ++i) {
      const std::uint32_t l = lists_.list[i] - first_list;  // wraps around if smaller
      if (l >= next.size()) continue;
      const std::uint32_t row = next[l]++;
      if (row < first || row >= end) continue;
      which.push_back(i);
      to.push_back(row - static_cast<std::uint32_t>(first));
    }
    features_.copy(which, to, rows);
  }

 private:
  LevelFeatures features_;
  CodeLists lists_;
};

/// The levels of an index, one after another, by rising resolution.
class Indexer {
 public:
  explicit Indexer(const WrittenFeatures& all) : all_(all) {
    std::map<float, std::vector<std::uint32_t>> levels;
    for (std::uint32_t i = 0; i < all.of_models.size(); ++i) {
      const TriSpinFeatures& features = all.of_models[i].features;
      if (features.size() > 0) levels[features.resolution].push_back(i);
    }
    for (auto& [resolution, of_level] : levels) levels_.push_back(std::move(of_level));
  }

  std::optional<LevelInPieces> level(std::size_t k) const {
    if (k >= levels_.size()) return std::nullopt;
    const auto maker = std::make_shared<const LevelMaker>(all_, levels_[k]);
    return LevelInPieces{
        maker->level(), [maker](std::size_t first, const auto& rows) { maker->list(first, rows); }};
  }

 private:
  WrittenFeatures all_;
  std::vector<std::vector<std::uint32_t>> levels_;  // levels of the features
};

/// Return freed memory of finished levels to the system. The allocator otherwise keeps tens of
/// megabytes of it, interleaved with memory in use.
void release_freed_memory() noexcept {
#if defined(__GLIBC__)
  ::malloc_trim(0);
#endif
}

/// A level with all its features in memory.
FeatureLevel in_memory(const LevelInPieces& made) {
  FeatureLevel level = made.level;
  const std::size_t n = made.size();
  Column<std::uint8_t> codes(n * level.stride);
  Column<std::uint32_t> model(n);
  Points keypoints(n);
  Column<RotationCode> frames(n);
  made.list(0, {codes, model, keypoints, frames});
  level.codes = std::move(codes);
  level.model = std::move(model);
  level.keypoints = std::move(keypoints);
  level.frames = std::move(frames);
  return level;
}

}  // namespace

Result<FeatureIndex> index_features(const Library& library) {
  std::vector<FeaturesOfModel> features;
  for (std::uint32_t m = 0; m < library.models.size(); ++m) {
    TRIVET_TRY_ASSIGN(const ModelFeatures* const of_model, library.features(m));
    for (const TriSpinFeatures& at_scale : of_model->features) features.push_back({m, at_scale});
  }
  const Indexer indexer({features, {}});
  FeatureIndex levels;
  for (std::size_t k = 0; const auto level = indexer.level(k); ++k)
    levels.push_back(in_memory(*level));
  return levels;
}

Result<void> add_index(LibraryWriter& writer, std::size_t piece_bytes) {
  std::optional<Indexer> indexer;
  return writer.add_index(
      [&](const WrittenFeatures& all, std::size_t k) {
        if (!indexer) indexer.emplace(all);
        release_freed_memory();
        return indexer->level(k);
      },
      piece_bytes);
}

kernels::CodeIndexView code_index(const FeatureLevel& level) noexcept {
  return {level.stride, level.centroids, level.offsets, level.codes};
}

}  // namespace trivet::engine
