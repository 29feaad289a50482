#include "apps/words/candidate_words.hpp"

#include <fmt/format.h>

#include "storage/common/counted.hpp"

namespace trivet::apps {

std::string candidate_words(const Candidate& candidate, const Eigen::Vector3d& offset,
                            std::string_view unit) {
  std::string words = fmt::format("{} {:.2f}", candidate.model, candidate.share);
  if (!candidate.differs) return words;
  const CandidateDifference& differs = *candidate.differs;
  const Eigen::Vector3d center = differs.center.cast<double>() + offset;
  words += fmt::format(": differs by up to {:.2g} {} around ({:.4g}, {:.4g}, {:.4g}); ",
                       differs.deviation, unit, center.x(), center.y(), center.z());
  words += candidate.rays == 0 ? "not seen from here"
                               : fmt::format("{} there", counted(candidate.rays, "ray"));
  const Eigen::Vector3f& from = differs.look_from;
  if (from.isZero(0)) return words;
  return words + fmt::format(", seen {}from ({:.2f}, {:.2f}, {:.2f})",
                             candidate.rays == 0 ? "" : "best ", from.x(), from.y(), from.z());
}

}  // namespace trivet::apps
