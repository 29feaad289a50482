/// Families of a library: models that a scan may not tell apart.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/loaded_library/recognizer.hpp"
#include "kernels/symmetry/find_difference.hpp"
#include "storage/common/result.hpp"

namespace trivet {

/// Two models whose surfaces nearly coincide.
struct FamilyPair {
  std::uint32_t first = 0, second = 0;  ///< indices in the library, rising
  Pose T_first_second = Pose::Identity();
  float agreeing =
      0;  ///< share of the surfaces that coincide, the smaller one of both models, 0..1
  kernels::SurfaceDifference difference{};  ///< in the frame of the first, in the library's unit
};

/// Models that are linked by pairs, not each with each.
struct Family {
  std::vector<std::uint32_t> models;  ///< rising, at least two
  std::vector<FamilyPair> pairs;      ///< those within the limit, rising
};

/// Share of the surfaces of a pair that coincide. A view shows a half of a surface or less; where the
/// rest is no more than a tenth, most views show little or nothing of it.
inline constexpr float kFamilyAgreement = 0.9F;

/// Find the families: models that coincide in kFamilyAgreement of their surfaces, to 0.8 % of the
/// diameter (engine::NearCopy).
///
/// deviation  largest distance of the surfaces of a pair, in the library's unit; absent: any
/// Same result for any number of threads. Errors: bad_data (the samples of a model are damaged).
Result<std::vector<Family>> find_families(const Recognizer& recognizer,
                                          const std::optional<float>& deviation);

}  // namespace trivet
