/// Average precision of ranked detections, as in object detection.
#pragma once

#include <cstddef>
#include <vector>

namespace trivet::engine {

/// An estimate that counts, and whether it matches an instance.
struct ScoredMatch {
  float score = 0;
  bool found = false;
};

/// Mean, over the recalls 0, 0.01 ... 1, of the best precision at that recall or above.
///
/// matches      matches of all images; sorted by falling score on return, ties in their order
/// num_targets  number of instances to find; 0 gives 0
/// Recalls are the multiples i * 0.01 in double arithmetic. Some of them lie an ulp beyond the
/// quotient i / 100, so a recall of 35 in 100 does not reach the 36th place. COCO and the BOP
/// toolkit compare the same numbers.
/// Source: Lin et al., ECCV 2014 (COCO), adopted by the BOP challenge 2024.
double average_precision(std::vector<ScoredMatch>& matches, std::size_t num_targets);

}  // namespace trivet::engine
