#include <cstdint>
#include <cstring>

#include "storage/common/columns.hpp"
#include "storage/library/model_record.hpp"

namespace trivet {
namespace {

/// Creates views of a file's columns.
class Mapper {
 public:
  Mapper(std::span<const std::byte> bytes, const std::shared_ptr<const void>& owner)
      : bytes_(bytes), owner_(owner) {}

  template <class T>
  Shared<std::span<const T>> column(const StoredColumn& stored) const {
    const auto bytes = bytes_.subspan(stored.offset, stored.bytes);
    const std::size_t n = bytes.size() / sizeof(T);
    if (reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(T) == 0)
      return {std::span(reinterpret_cast<const T*>(bytes.data()), n), owner_};
    Column<T> copied(n);
    std::memcpy(copied.data(), bytes.data(), n * sizeof(T));
    return copied;
  }

  /// A view of three rows of equal length.
  template <class View, class T>
  Shared<View> rows(const StoredColumn& stored) const {
    const auto all = std::make_shared<const Shared<std::span<const T>>>(column<T>(stored));
    const std::size_t n = all->size() / 3;
    return {View{all->subspan(0, n), all->subspan(n, n), all->subspan(2 * n, n)}, all};
  }
  Shared<PointsView> points(const StoredColumn& stored) const {
    return rows<PointsView, float>(stored);
  }

 private:
  std::span<const std::byte> bytes_;
  const std::shared_ptr<const void>& owner_;
};

}  // namespace

std::vector<Pose> poses_of(std::span<const float> numbers) {
  std::vector<Pose> out(numbers.size() / 16);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].matrix() =
        Eigen::Map<const Eigen::Matrix<float, 4, 4, Eigen::RowMajor>>(numbers.data() + 16 * i);
  }
  return out;
}

Model map_model(const ModelRecord& record, std::span<const std::byte> bytes,
                const std::shared_ptr<const void>& owner, std::size_t num_components) {
  const Mapper map(bytes, owner);
  Model model = record.traits;
  auto next = record.columns.begin();  // in the order of kModelColumns
  model.vertices = map.points(*next++);
  model.triangles = map.rows<TrianglesView, std::uint32_t>(*next++);
  model.samples = map.points(*next++);
  model.sample_normals = map.points(*next++);
  model.sample_views = map.column<ViewMask>(*next++);
  model.ppf_points = map.points(*next++);
  model.ppf_normals = map.points(*next++);
  const auto offsets = std::make_shared<const Shared<std::span<const std::uint32_t>>>(
      map.column<std::uint32_t>(*next++));
  const auto entries =
      std::make_shared<const Shared<std::span<const PpfEntry>>>(map.column<PpfEntry>(*next++));
  PpfTableView table = model.ppf;
  table.offsets = *offsets;
  table.entries = *entries;
  model.ppf = {
      table,
      std::make_shared<const std::pair<std::shared_ptr<const void>, std::shared_ptr<const void>>>(
          offsets, entries)};
  for (TriSpinFeatures& features : model.features) {
    features.keypoints = map.points(*next++);
    features.frames = map.column<FrameRows>(*next++);
    features.codes = map.column<std::uint8_t>(*next++);
    features.num_components = num_components;
  }
  return model;
}

FeatureLevel map_level(float resolution, std::size_t stride, const LevelColumns& columns,
                       std::span<const std::byte> bytes, const std::shared_ptr<const void>& owner) {
  const Mapper map(bytes, owner);
  FeatureLevel level;
  level.resolution = resolution;
  level.stride = stride;
  auto next = columns.begin();  // in the order of kLevelColumns
  level.models = map.column<std::uint32_t>(*next++);
  level.centroids = map.column<std::uint8_t>(*next++);
  level.offsets = map.column<std::uint32_t>(*next++);
  level.codes = map.column<std::uint8_t>(*next++);
  level.model = map.column<std::uint32_t>(*next++);
  level.keypoints = map.points(*next++);
  level.frames = map.column<RotationCode>(*next++);
  return level;
}

}  // namespace trivet
