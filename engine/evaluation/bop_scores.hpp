/// The scores of the BOP benchmark: recall of 6-D localization, precision of 6-D detection.
///
/// Sources: Hodan et al., BOP Challenge 2020, ECCVW 2020, section 2 (localization); Nguyen et al.,
/// BOP Challenge 2024, CVPRW 2025 (detection). Where these give no details, the implementation
/// follows the benchmark's toolkit: https://github.com/thodan/bop_toolkit.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/evaluation/evaluation_meshes.hpp"
#include "engine/results/recognize_result.hpp"
#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/model.hpp"
#include "storage/datasets/manifest.hpp"

namespace trivet {

struct BopOptions {
  /// Maximum distance behind the measurement at which a surface counts as visible, > 0. The
  /// benchmark uses 5 for ITODD, 15 for all others.
  double vsd_delta_mm = 15;
  bool operator==(const BopOptions&) const = default;
};

/// The tolerances of VSD and the thresholds of VSD and MSSD, in diameters: 0.05, 0.1 ... 0.5.
/// Computed like this, they have the same bits as those of the toolkit.
inline constexpr std::array<double, 10> kBopShares = [] {
  std::array<double, 10> shares{};
  for (int i = 0; i < 10; ++i) shares[static_cast<std::size_t>(i)] = 0.05 + i * 0.05;
  return shares;
}();

/// Average recalls over the thresholds, 0..1. VSD and MSPD require depth images with a camera and
/// count only the instances in such scenes; they are absent if no scene has one.
struct BopRecall {
  std::size_t num_targets = 0;  ///< number of instances to find
  std::optional<double> vsd;    ///< mean over 10 tolerances and 10 thresholds; needs mesh faces
  double mssd = 0;              ///< mean over thresholds of 0.05 to 0.5 diameters
  std::optional<double> mspd;  ///< mean over thresholds of 5 to 50 pixels in images 640 pixels wide
  std::optional<double> mean;  ///< mean of the three, the benchmark's AR
};

/// Average precisions, as means over the thresholds, then over the models with targets.
struct BopPrecision {
  std::size_t num_targets = 0;  ///< number of instances to find
  /// Detections of models without any instance in the image. The toolkit drops them, so they lower
  /// no precision.
  std::size_t num_absent = 0;
  double mssd = 0;             ///< mean over thresholds of 0.05 to 0.5 diameters
  std::optional<double> mspd;  ///< mean over thresholds of 5 to 50 pixels in images 640 pixels wide
  std::optional<double> mean;  ///< mean of MSSD and MSPD, the benchmark's AP
  double mssd_mm = 0;          ///< mean over thresholds of 2 to 20 mm, not part of `mean`
};

/// Errors of one detection relative to the instance of its model that is nearest by MSSD.
struct BopErrors {
  std::size_t truth = 0;                      ///< index in the scene's truth
  double mssd = 0;                            ///< [manifest unit]
  std::optional<double> mspd;                 ///< [pixel of an image 640 pixels wide]
  std::optional<std::array<double, 10>> vsd;  ///< 0..1, by tolerance (kBopShares)
  /// The VSD error shown in tables, at the tolerance of 0.2 diameters.
  std::optional<double> vsd_at_20_percent() const {
    return vsd ? std::optional((*vsd)[3]) : std::nullopt;
  }
};

struct BopScores {
  BopRecall localization;
  BopPrecision detection;
  /// By scene and detection, as in the results; absent for models that are not scored or have no
  /// instance in the scene.
  std::vector<std::vector<std::optional<BopErrors>>> errors;
};

/// Score results against the ground truth of a manifest.
///
/// meshes   one per scored model, in any order
/// results  one per scene of the manifest, poses in the manifest's unit; absent if recognition did
///          not run: its instances count as not found
///
/// Localization: a scene's targets define how many instances of a model must be found; without
/// targets, these are all instances that are visible by at least 10 %. This number of best-scored
/// detections and of most visible truths is used per model. In the order of falling score, each
/// detection is assigned the free truth with the smallest error, if that is below the threshold.
/// Recall is over the truths of all scenes.
/// Detection: the 100 best-scored detections of an image are assigned truths in the same way.
/// Truths visible by less than 10 % are included, but they and the detections assigned to them
/// count neither way. Precision is interpolated at 101 recalls.
/// The visible share is `visible_fraction`; where it is unknown, truths to be ignored count as
/// hidden and all others as visible. Ties: the first in the file's order.
/// Same bits for any number of threads.
/// Errors: bad_data (no mesh for a scored model; a mesh without vertices or diameter), those of
/// reading depth images.
Result<BopScores> bop_scores(const Manifest& manifest, std::span<const EvaluationMesh> meshes,
                             std::span<const std::optional<SceneResult>> results,
                             const BopOptions& options = {});

}  // namespace trivet
