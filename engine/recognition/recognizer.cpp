#include "engine/recognizer.hpp"

#include <tbb/collaborative_call_once.h>

#include <optional>
#include <utility>

#include "engine/hypotheses/feature_library.hpp"
#include "engine/hypotheses/find_look_alikes.hpp"
#include "kernels/surfaces/visibility.hpp"

namespace trivet {

struct Recognizer::Surface {
  tbb::collaborative_once_flag once;
  std::optional<Result<kernels::RayScene>> rays;
};

struct Recognizer::Features {
  tbb::collaborative_once_flag once;
  std::vector<engine::FeatureLevel> levels;
};

struct Recognizer::LookAlikes {
  tbb::collaborative_once_flag once;
  std::vector<engine::LookAlike> models;
};

Recognizer::Recognizer(Library library, const kernels::ScoreModel& score)
    : library_(std::move(library)),
      score_(score),
      surfaces_(new Surface[library_.models.size()]),
      features_(new Features),
      look_alikes_(new LookAlikes[library_.models.size()]) {}
Recognizer::Recognizer(Recognizer&&) noexcept = default;
Recognizer& Recognizer::operator=(Recognizer&&) noexcept = default;
Recognizer::~Recognizer() = default;

const Result<kernels::RayScene>& Recognizer::surface(std::uint32_t model) const {
  Surface& surface = surfaces_[model];
  // Embree builds with TBB: a waiting thread may take up another scene that asks for this model,
  // which std::call_once would never come back from.
  tbb::collaborative_call_once(surface.once, [&] {
    const Model& m = library_.models[model];
    surface.rays = m.triangles.empty()
                       ? kernels::RayScene::from_discs(m.samples, m.sample_normals,
                                                       kernels::kCloudRadius * m.sample_spacing)
                       : kernels::RayScene::from_mesh(m.vertices, m.triangles);
  });
  return *surface.rays;
}

const std::vector<engine::FeatureLevel>& Recognizer::features() const {
  tbb::collaborative_call_once(features_->once,
                               [&] { features_->levels = engine::index_features(library_); });
  return features_->levels;
}

const std::vector<engine::LookAlike>& Recognizer::look_alikes(std::uint32_t model) const {
  LookAlikes& look_alikes = look_alikes_[model];
  tbb::collaborative_call_once(look_alikes.once, [&] {
    look_alikes.models = engine::find_look_alikes(library_, features(), model);
  });
  return look_alikes.models;
}

void Recognizer::build_all() const {
  for (std::uint32_t model = 0; model < library_.models.size(); ++model) (void)surface(model);
  (void)features();
}

}  // namespace trivet
