/// What a model's keypoints look like from all sides.
#pragma once

#include <cstdint>
#include <memory>

#include "engine/common/describe_surface.hpp"
#include "engine/training/survey_model.hpp"

namespace trivet::engine {

/// How models are described: lengths in resolutions, which are steps of about an eightieth of the
/// diameter, rounded to half an octave, so that models of like size share one.
struct DescribeOptions {
  std::uint32_t half_octaves = 0;  ///< above the model's own resolution
  float support = 17;              ///< radius of a support
  float spacing = 3;               ///< of keypoints
  std::size_t stride = 1;          ///< one in so many keypoints is described
  kernels::FrameLimits limits{.min_points = 10};
};

/// The distance between the points that supports are made of, for a model of this diameter, and so
/// many half octaves above it. Models of different size share what is equal.
float resolution_for(float diameter, std::uint32_t half_octaves = 0) noexcept;

/// Describes the keypoints of a model as the whole surface shows them and as 42 views do: what a view
/// does not see is missing from its supports, as it is in a scan.
///
/// Views that see nearly the same of a support count as one. Of a keypoint come at most five
/// descriptions, those of the views that most others are like; none hardly differs from another.
/// Source: partial views instead of whole models, Guo et al., IJCV 2013, section 5, taken further.
class ModelDescriber {
 public:
  ModelDescriber(const SurveyedModel& model, const DescribeOptions& options);
  ModelDescriber(ModelDescriber&&) noexcept;
  ModelDescriber& operator=(ModelDescriber&&) noexcept;
  ~ModelDescriber();

  /// Runs of keypoints, which may be described at once.
  std::size_t num_chunks() const noexcept;
  /// Append the descriptions of a chunk's keypoints, in their order.
  void describe(std::size_t chunk, Descriptions& out) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// All chunks, one after the other.
Descriptions describe_model(const SurveyedModel& model, const DescribeOptions& options);

}  // namespace trivet::engine
