#include "engine/hypotheses/find_look_alikes.hpp"

#include <algorithm>
#include <map>

#include "engine/hypotheses/search_codes.hpp"
#include "engine/libraries/index_features.hpp"
#include "kernels/spin_images/rotation_code.hpp"
#include "kernels/verification/cluster_poses.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kQueries = 300;    // features of the model, spread over it
constexpr std::size_t kLists = 8;        // that each is looked for in
constexpr std::size_t kNeighbors = 100;  // hundreds of look-alikes share them
constexpr std::size_t kOfAModel = 2;     // matches of a query with one other model
constexpr float kFewestMatches = 3;      // that make a look-alike
constexpr std::size_t kMostLookAlikes = 40;
constexpr float kClusterTranslation = 0.1F;   // [diameters]
constexpr float kClusterRotationRad = 0.26F;  // 15 degrees

/// Where the other models lie by each match, by model.
using Poses = std::map<std::uint32_t, std::vector<kernels::Hypothesis>>;

void add_poses(const FeatureLevel& level, const TriSpinFeatures& own, std::uint32_t model,
               Poses& poses) {
  const std::size_t k = own.num_components, n = own.size(), num = std::min(n, kQueries);
  std::vector<std::size_t> rows;
  Column<std::uint8_t> codes;
  for (std::size_t q = 0; q < num; ++q) {
    rows.push_back(q * n / num);
    const auto code = own.codes.subspan(rows.back() * k, k);
    codes.insert(codes.end(), code.begin(), code.end());
  }
  Column<std::uint8_t> queries(num * kernels::code_stride(k));
  kernels::pad_codes(codes, k, queries);
  const CodeNeighbors nearest = search_codes(code_index(level), queries, kLists, kNeighbors);
  for (std::size_t q = 0; q < num; ++q) {
    const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> frame(
        own.frames[rows[q]].data());
    std::map<std::uint32_t, std::size_t> matched;
    for (const kernels::CodeNeighbor& neighbor : nearest.of(q)) {
      const std::uint32_t i = neighbor.index;
      if (i == kernels::CodeNeighbor::kNone) break;
      const std::uint32_t other = level.model[i];
      if (other == model || ++matched[other] > kOfAModel) continue;
      Pose pose = Pose::Identity();
      pose.linear() = frame.transpose() * kernels::decode_rotation(level.frames[i]);
      pose.translation() = own.keypoints[rows[q]] - pose.linear() * level.keypoints[i];
      poses[other].push_back({pose, 1});
    }
  }
}

}  // namespace

Result<std::vector<LookAlike>> find_look_alikes(const Library& library, const FeatureIndex& index,
                                                std::uint32_t model) {
  const Model& own = library.models[model];
  if (const Result<void> good = library.check(model, ModelPart::features); !good)
    return good.error();
  Poses poses;
  const TriSpinFeatures& features = own.features[0];
  const auto level = std::ranges::find(index, features.resolution, &FeatureLevel::resolution);
  if (level != index.end() && features.size() > 0) {
    const Result<void> good = library.check_level(static_cast<std::size_t>(level - index.begin()));
    if (!good) return good.error();
    add_poses(*level, features, model, poses);
  }
  std::vector<std::pair<float, LookAlike>> found;
  for (const auto& [other, of_other] : poses) {
    const Model& like = library.models[other];
    for (const kernels::Hypothesis& cluster :
         kernels::cluster_poses(of_other, like.symmetry, like.center,
                                {kClusterTranslation * own.diameter, kClusterRotationRad, 2})) {
      if (cluster.votes >= kFewestMatches)
        found.emplace_back(cluster.votes, LookAlike{other, cluster.T_scene_model});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  found.resize(std::min(found.size(), kMostLookAlikes));
  std::vector<LookAlike> look_alikes;
  for (const auto& [votes, look_alike] : found) look_alikes.push_back(look_alike);
  return look_alikes;
}

}  // namespace trivet::engine
