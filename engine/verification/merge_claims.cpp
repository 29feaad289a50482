#include "engine/merge_claims.hpp"

#include <limits>
#include <map>
#include <string>

#include "engine/verification/select_detections.hpp"

namespace trivet {

Result<std::vector<DetectionPlace>> merge_claims(std::span<const SceneClaims> libraries) {
  std::vector<engine::Claim> claims;
  std::vector<std::pair<std::size_t, const PoseClaim*>> sources;
  std::map<std::string, std::uint32_t> models;
  for (std::size_t k = 0; k < libraries.size(); ++k) {
    if (libraries[k].images != libraries.front().images) {
      return Error{ErrorCode::bad_data,
                   "expected results of one scene in images of one size, found other sizes"};
    }
    for (const PoseClaim& pose : libraries[k].poses) {
      const auto next = static_cast<std::uint32_t>(models.size());
      const std::uint32_t model = models.emplace(pose.model, next).first->second;
      claims.push_back({model, 1, pose.rank, &pose.explained});
      sources.emplace_back(k, &pose);
    }
  }
  std::vector<DetectionPlace> standing;
  if (claims.empty()) return standing;
  // Each library has bounded its instances, and taken nothing doubtful.
  const engine::SelectOptions options{.max_instances = std::numeric_limits<std::uint32_t>::max()};
  for (const std::uint32_t c :
       engine::select_claims(libraries.front().images, claims, options).chosen) {
    const auto [library, pose] = sources[c];
    if (pose->detection) standing.push_back({library, *pose->detection});
  }
  return standing;
}

}  // namespace trivet
