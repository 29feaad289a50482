/// A library prepared for recognition.
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
struct NearCopy;
}  // namespace engine

/// Maximum memory of a library. The memory in use for a scene may exceed it; released data is read
/// or computed again when needed.
struct MemoryBound {
  static constexpr std::size_t kDefault = std::size_t{768} << 20U;

  std::size_t bytes = kDefault;  ///< memory of file pages and ray-tracing trees
};

/// A library and its models' surfaces for ray casting. One instance serves any number of scenes and
/// threads in parallel.
class Recognizer {
 public:
  explicit Recognizer(Library library, const kernels::ScoreModel& score = default_score(),
                      const MemoryBound& memory = {});
  Recognizer(Recognizer&&) noexcept;
  Recognizer& operator=(Recognizer&&) noexcept;
  ~Recognizer();

  const Library& library() const noexcept { return library_; }
  const kernels::ScoreModel& score() const noexcept { return score_; }
  /// The surface of a model, built if necessary. It consists of the model's faces, or of discs on
  /// its samples if it was trained from a cloud without a reconstructed surface. Errors: damaged,
  /// internal (Embree's message).
  Result<std::shared_ptr<const kernels::RayScene>> surface(std::uint32_t model) const;
  /// The Tri-Spin-Images of all models. For files from before version 1.4 they are indexed on first
  /// use. Errors: damaged.
  Result<const FeatureLevels*> features() const;
  /// Models that look like this one, determined on first use. Errors: damaged.
  Result<const std::vector<engine::LookAlike>*> look_alikes(std::uint32_t model) const;
  /// Look-alikes most of whose surfaces coincide with this one's, determined on first use. Errors:
  /// damaged.
  Result<const std::vector<engine::NearCopy>*> near_copies(std::uint32_t model) const;
  /// Check the pairs and samples of all models and build their surfaces, so that the first scene
  /// takes no longer than later ones; of a library that exceeds the memory bound nothing. Damaged
  /// models are left to the scenes that need them.
  void make_ready() const;
  /// Release pages of the mapped file beyond the bound, between scenes and between levels of the
  /// index.
  void release_memory() const;

 private:
  struct Parts;
  Library library_;
  kernels::ScoreModel score_;
  MemoryBound memory_;
  std::unique_ptr<Parts> parts_;
};

}  // namespace trivet
