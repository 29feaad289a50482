/// A library made ready to recognize with.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/default_score.hpp"
#include "kernels/common/ray_scene.hpp"
#include "storage/library.hpp"
#include "storage/result.hpp"

namespace trivet {

namespace engine {
struct FeatureLevel;
struct LookAlike;
}  // namespace engine

/// A library, and the surfaces of its models that rays can be shot at. One serves any number of
/// scenes and threads at the same time.
class Recognizer {
 public:
  explicit Recognizer(Library library, const kernels::ScoreModel& score = default_score());
  Recognizer(Recognizer&&) noexcept;
  Recognizer& operator=(Recognizer&&) noexcept;
  ~Recognizer();

  const Library& library() const noexcept { return library_; }
  const kernels::ScoreModel& score() const noexcept { return score_; }
  /// The surface of a model, built when it is first asked for: its faces, or discs on its samples
  /// where it was trained from a cloud that no surface could be laid through. Errors: internal
  /// (Embree's message).
  const Result<kernels::RayScene>& surface(std::uint32_t model) const;
  /// The Tri-Spin-Images of all models, indexed when they are first asked for.
  const std::vector<engine::FeatureLevel>& features() const;
  /// Models that look like this one, found when they are first asked for.
  const std::vector<engine::LookAlike>& look_alikes(std::uint32_t model) const;
  /// Build all that would be built when it is first asked for, so that no scene waits for it.
  void build_all() const;

 private:
  struct Surface;
  struct Features;
  struct LookAlikes;
  Library library_;
  kernels::ScoreModel score_;
  std::unique_ptr<Surface[]> surfaces_;
  std::unique_ptr<Features> features_;
  std::unique_ptr<LookAlikes[]> look_alikes_;
};

}  // namespace trivet
