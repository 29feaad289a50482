#include "engine/hypotheses/propose_expected.hpp"

#include <utility>

namespace trivet::engine {

std::vector<Proposals> propose_expected(const Library& library, const ModelGroups& groups,
                                        std::span<const ExpectedPose> expected, double scale) {
  std::vector<Proposals> proposals;
  for (const auto& [step, models] : groups) {
    for (const std::uint32_t m : models) {
      Proposals of_model{m, Source::expected, {}};
      for (const ExpectedPose& pose : expected) {
        if (pose.model != library.models[m].name) continue;
        of_model.hypotheses.push_back({pose.T_scene_model.cast<float>(), 1});
        of_model.hypotheses.back().T_scene_model.translation() *= static_cast<float>(scale);
      }
      proposals.push_back(std::move(of_model));
    }
  }
  return proposals;
}

}  // namespace trivet::engine
