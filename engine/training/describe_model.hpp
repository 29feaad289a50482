/// Features of a model's keypoints from all sides.
#pragma once

#include <cstdint>
#include <memory>

#include "engine/common/describe_surface.hpp"
#include "engine/training/survey_model.hpp"

namespace trivet::engine {

/// Options of describing models. Lengths are in resolutions, which are about an eightieth of the
/// diameter, rounded to half an octave, so that models of similar size share one.
struct DescribeOptions {
  std::uint32_t half_octaves = 0;  ///< steps above the model's own resolution
  float support = 17;              ///< radius of a support
  float spacing = 3;               ///< spacing of keypoints
  std::size_t stride = 1;          ///< interval of described keypoints
  kernels::FrameLimits limits{.min_points = 10};
};

/// The spacing of the supports' points for a model of this diameter, with a number of half octaves
/// above it. Models of different sizes with equal spacing share a level.
float resolution_for(float diameter, std::uint32_t half_octaves = 0) noexcept;

/// Describes the keypoints of a model from the whole surface and from 42 views. Surface that a view
/// does not see is missing from its supports, as in a scan.
///
/// Views that see nearly the same of a support count as one. A keypoint has at most five
/// descriptions, from the most typical views, without near duplicates.
/// Source: partial views instead of whole models, Guo et al., IJCV 2013, section 5, extended.
class ModelDescriber {
 public:
  ModelDescriber(const SurveyedModel& model, const DescribeOptions& options);
  ModelDescriber(ModelDescriber&&) noexcept;
  ModelDescriber& operator=(ModelDescriber&&) noexcept;
  ~ModelDescriber();

  /// Number of chunks of keypoints, which may be described in parallel.
  std::size_t num_chunks() const noexcept;
  /// Append the descriptions of a chunk's keypoints, in their order.
  void describe(std::size_t chunk, Descriptions& out) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Describe all chunks, one after another.
Descriptions describe_model(const SurveyedModel& model, const DescribeOptions& options);

}  // namespace trivet::engine
