#include "storage/library/write_level.hpp"

#include <algorithm>
#include <array>
#include <future>
#include <limits>
#include <span>

#include "storage/common/columns.hpp"
#include "storage/files/file.hpp"
#include "storage/library/library_format.hpp"
#include "storage/library/write_hdf5.hpp"

namespace trivet {
namespace {

using hdf5::Handle;

/// Buffer for some features.
class Piece {
 public:
  Piece(std::size_t n, std::size_t stride)
      : stride_(stride), codes_(n * stride), model_(n), keypoints_(3 * n), frames_(n) {}
  /// The keypoints' rows are contiguous, as for writing.
  ListedFeaturesSpan first(std::size_t n) {
    const std::span keypoints(keypoints_);
    return {std::span(codes_).first(n * stride_),
            std::span(model_).first(n),
            {keypoints.first(n), keypoints.subspan(n, n), keypoints.subspan(2 * n, n)},
            std::span(frames_).first(n)};
  }

 private:
  std::size_t stride_;
  Column<std::uint8_t> codes_;
  Column<std::uint32_t> model_;
  Column<float> keypoints_;
  Column<RotationCode> frames_;
};

/// The datasets of a level's features, in the order of their offsets in the file.
class FeatureDatasets {
 public:
  FeatureDatasets(hid_t group, std::size_t n, std::size_t stride, std::string_view unit,
                  StoredGroup& stored)
      : stride_(stride), stored_(stored) {
    for (std::size_t c = 0; c < kSpecs.size(); ++c) {
      const format::DatasetSpec& spec = kSpecs[c];
      const std::uint64_t row =
          std::array{stride, sizeof(std::uint32_t), 3 * sizeof(float), sizeof(RotationCode)}[c];
      // The checksum is known only at the end, but its space is reserved at once: otherwise the
      // position of an attribute would depend on the time of its writing.
      StoredDataset& dataset = stored.datasets[std::string(spec.name)];
      dataset = hdf5::describe(spec, n * row, Xxh3().hex(), unit, 0, stride);
      datasets_[c] = hdf5::create_dataset(group, std::string(spec.name), dataset);
    }
  }
  explicit operator bool() const noexcept {
    return std::ranges::all_of(datasets_, [](const Handle& one) { return static_cast<bool>(one); });
  }

  bool write(std::size_t at, const ListedFeaturesSpan& features) const {
    const hsize_t first = at, n = features.size(), stride = stride_;
    using Extents = std::array<hsize_t, 2>;
    const auto block = [&](std::size_t c, const Extents& from, const Extents& count,
                           const void* elements) {
      const std::size_t rank = kSpecs[c].rank;
      return hdf5::write_block(datasets_[c].get(), kSpecs[c].type, std::span(from).first(rank),
                               std::span(count).first(rank), elements);
    };
    return block(0, {first, 0}, {n, stride}, features.codes.data()) &&
           block(1, {first, 0}, {n, 0}, features.model.data()) &&
           block(2, {0, first}, {3, n}, features.keypoints.x.data()) &&
           block(3, {first, 0}, {n, 4}, features.frames.data());
  }

  /// Checksums are computed from the file, as the rows of the keypoints came in pieces.
  bool write_checksums(const std::filesystem::path& file) const {
    for (const Handle& dataset : datasets_) {
      if (H5Dflush(dataset.get()) < 0) return false;
    }
    const auto mapped = MappedFile::open(file, std::numeric_limits<std::uint64_t>::max());
    if (!mapped) return false;
    for (std::size_t c = 0; c < kSpecs.size(); ++c) {
      StoredDataset& dataset = stored_.datasets.at(std::string(kSpecs[c].name));
      if (dataset.offset + dataset.bytes > mapped->bytes().size()) return false;
      const auto bytes = mapped->bytes().subspan(dataset.offset, dataset.bytes);
      const StoredAttribute sum = hdf5::attribute(xxh3_of_mapped(bytes).hex());
      release_pages(bytes);
      dataset.attributes.at(std::string(format::kDataChecksum)) = sum;
      if (!hdf5::rewrite_attribute(datasets_[c].get(), std::string(format::kDataChecksum), sum))
        return false;
    }
    return true;
  }

 private:
  static constexpr std::array kSpecs{format::kListCodes, format::kListModel, format::kListKeypoints,
                                     format::kListFrames};
  std::size_t stride_;
  StoredGroup& stored_;
  std::array<Handle, kSpecs.size()> datasets_;
};

/// Write the columns that a level has once.
bool write_lists(const FeatureLevel& level, hid_t group, std::string_view unit,
                 StoredGroup& stored) {
  stored.attributes.emplace("resolution", hdf5::attribute(level.resolution));
  stored.attributes.emplace("stride", hdf5::attribute(static_cast<std::uint32_t>(level.stride)));
  const auto put = [&](const format::DatasetSpec& spec, std::span<const std::byte> bytes) {
    StoredDataset& dataset = stored.datasets[std::string(spec.name)];
    dataset = hdf5::describe(spec, bytes.size(), xxh3_hex(bytes), unit, 0, level.stride);
    return hdf5::write_dataset(group, std::string(spec.name), dataset, bytes);
  };
  return hdf5::write_attributes(group, stored.attributes) &&
         put(format::kLevelModels, std::as_bytes(std::span(level.models))) &&
         put(format::kListCentroids, std::as_bytes(std::span(level.centroids))) &&
         put(format::kListOffsets, std::as_bytes(std::span(level.offsets)));
}

}  // namespace

Result<void> write_level(const LevelInPieces& made, const std::string& name, hid_t index,
                         const LevelPlace& place, StoredGroup& stored) {
  const Error failed{ErrorCode::io, name};
  const auto broken = [](const Error& error) { return Error{ErrorCode::internal, error.message}; };
  const FeatureLevel& level = made.level;
  if (const auto good = format::check_lists(level, place.num_models); !good)
    return broken(good.error());
  const Handle group = hdf5::create_group(index, name);
  if (!group || !write_lists(level, group.get(), place.unit, stored)) return failed;

  const std::size_t n = made.size();
  const FeatureDatasets datasets(group.get(), n, level.stride, place.unit, stored);
  if (!datasets) return failed;
  const std::size_t row_bytes =
      level.stride + sizeof(std::uint32_t) + 3 * sizeof(float) + sizeof(RotationCode);
  // While a piece is written, the next one is computed, even if the level would fit into one.
  const std::size_t at_once =
      std::max(std::min(place.piece_bytes / 2 / row_bytes, n / 4 + 1), std::size_t{1});
  std::array pieces{Piece(at_once, level.stride), Piece(at_once, level.stride)};
  const auto make = [&](std::size_t k) {
    const std::size_t at = k * at_once;
    const ListedFeaturesSpan features = pieces[k % 2].first(std::min(at_once, n - at));
    made.list(at, features);
    return features;
  };
  const std::size_t num_pieces = (n + at_once - 1) / at_once;
  std::future<ListedFeaturesSpan> next;
  for (std::size_t k = 0; k < num_pieces; ++k) {
    const ListedFeaturesSpan features = k == 0 ? make(0) : next.get();
    if (k + 1 < num_pieces) next = std::async(std::launch::async, make, k + 1);
    const auto good = format::check_listed(features.model, features.keypoints, place.num_models);
    if (!good) return broken(good.error());
    if (!datasets.write(k * at_once, features)) return failed;
  }
  if (!datasets.write_checksums(place.file)) return failed;
  return {};
}

}  // namespace trivet
