/// Choose the set of candidates that together explain the scene.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "engine/scene/prepare_scene.hpp"
#include "engine/verification/candidate.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

struct SelectOptions {
  float min_score = 0.8F;                 ///< that detections are reported from, 0..1
  std::optional<float> doubtful_score{};  ///< from it to min_score they are taken last
  std::uint32_t max_instances = 100;      ///< per model
  float max_overlap = 0.4F;               ///< share of a claim's pixels that may be explained
  bool by_pixels = true;                  ///< else copies are told by their poses alone
  bool operator==(const SelectOptions&) const = default;
};

/// Of an image that a scene was looked at in.
struct ImageSize {
  std::uint32_t width = 0, height = 0;  ///< [pixel]
};

/// A candidate as the selection sees it.
struct Claim {
  std::uint32_t model = 0;
  float score = 0;
  float rank = 0;  ///< higher ones choose first
  const kernels::ExplainedPixels* explained = nullptr;
};

/// A candidate that was not taken.
struct RejectedCandidate {
  std::uint32_t candidate = 0;
  Rejection reason = Rejection::too_low;
  /// The better candidate that explains most of its pixels, where better ones explain more than
  /// max_overlap of them; and what share of them that one explains.
  std::optional<std::uint32_t> explained_by{};
  float explained_share = 0;
};

struct Selection {
  std::vector<std::uint32_t> chosen;  ///< indices of the candidates taken, in the order of taking
  std::vector<std::uint8_t>
      explained;  ///< one a pixel over all images: 1 where a quite sure one explains it
  std::vector<RejectedCandidate> refused;  ///< all others, from the best to the worst
};

/// Whether a claim is one of those that are taken again.
using Repeats = std::function<bool(std::span<const std::uint32_t> taken, std::uint32_t claim)>;

/// Take claims by falling rank, each unless better ones already explain more than max_overlap of
/// its pixels: copies of one object fall out whatever their symmetry, and of two objects claiming
/// one place the better explained stays. Ties go to the earlier claim. Doubtful ones come after all
/// others.
/// repeats  if given, decides instead of the pixels
Selection select_claims(std::span<const ImageSize> images, std::span<const Claim> claims,
                        const SelectOptions& options, const Repeats& repeats = {});

/// Take those of the refused claims from min_score on that were hidden by one that does not stand
/// after all, unless what stands explains them, or a better one of them does.
///
/// standing  indices of the claims that were taken and stand; what was one too many does, too
/// refused   of all claims; loses what is taken, and tells what hides the others now
/// Returns the indices of those taken, in the order of taking.
std::vector<std::uint32_t> take_unexplained(std::span<const ImageSize> images,
                                            std::span<const Claim> claims,
                                            std::span<const std::uint32_t> standing,
                                            const SelectOptions& options,
                                            std::vector<RejectedCandidate>& refused);

std::vector<ImageSize> sizes_of(const PreparedScene& scene);

/// They refer to the candidates.
std::vector<Claim> claims_of(const Library& library, std::span<const Candidate> candidates,
                             const SelectOptions& options);

/// Select by the pixels that candidates explain, or by their poses alone.
Selection select_detections(const Library& library, const PreparedScene& scene,
                            std::span<const Candidate> candidates, const SelectOptions& options);

/// Of each model the best refused candidates by score, at most `limit`; first of all those whose
/// pixels no better one of their own model explains, which may be further instances. Those that
/// repeat the placement of one taken, or of a detection or its alternatives, are left out.
/// detections  the chosen candidates as they are reported
/// Returns them by falling score, ties in the order of refusal.
std::vector<RejectedCandidate> best_refused(const Library& library,
                                            std::span<const Candidate> candidates,
                                            std::span<const RejectedCandidate> refused,
                                            std::span<const Candidate> detections,
                                            std::uint32_t limit);

}  // namespace trivet::engine
