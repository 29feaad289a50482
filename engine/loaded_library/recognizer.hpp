/// A library made ready to recognize with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/loaded_library/default_score.hpp"
#include "kernels/common/ray_scene.hpp"
#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet {

namespace engine {
struct LookAlike;
}  // namespace engine

/// What a library may take of the memory. What a scene needs at once stays beyond it; what is given
/// back is read, or made, again when it is needed again.
struct MemoryBound {
  static constexpr std::size_t kDefault = std::size_t{768} << 20U;

  std::size_t bytes = kDefault;  ///< pages of the file, and ray-tracing trees
};

/// A library, and the surfaces of its models that rays can be shot at. One serves any number of
/// scenes and threads at the same time.
class Recognizer {
 public:
  explicit Recognizer(Library library, const kernels::ScoreModel& score = default_score(),
                      const MemoryBound& memory = {});
  Recognizer(Recognizer&&) noexcept;
  Recognizer& operator=(Recognizer&&) noexcept;
  ~Recognizer();

  const Library& library() const noexcept { return library_; }
  const kernels::ScoreModel& score() const noexcept { return score_; }
  /// The surface of a model, built unless it is there: its faces, or discs on its samples where it
  /// was trained from a cloud that no surface could be laid through. Errors: bad_data (damaged),
  /// internal (Embree's message).
  Result<std::shared_ptr<const kernels::RayScene>> surface(std::uint32_t model) const;
  /// The Tri-Spin-Images of all models; of a file of before 1.4 indexed when they are first asked
  /// for. Each level must be checked before it is read. Errors: bad_data (damaged).
  Result<const FeatureIndex*> features() const;
  /// Models that look like this one, found when they are first asked for. Errors: bad_data.
  Result<const std::vector<engine::LookAlike>*> look_alikes(std::uint32_t model) const;
  /// Let go of pages of the file beyond the bound: between scenes, and between levels of the index.
  void give_back() const;

 private:
  struct Parts;
  Library library_;
  kernels::ScoreModel score_;
  MemoryBound memory_;
  std::unique_ptr<Parts> parts_;
};

}  // namespace trivet
