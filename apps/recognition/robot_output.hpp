/// Detections as a table of poses for a robot controller.
#pragma once

#include <memory>
#include <string>

#include "apps/recognition/output.hpp"
#include "apps/recognition/outputs.hpp"
#include "apps/recognition/recognize_request.hpp"
#include "apps/results/robot_table.hpp"

namespace trivet::apps {

/// One row per grasp of each detection, or for the model's frame if it has no grasps. The last
/// column names the frame: "robot", or "scene" without a hand-eye calibration.
class RobotOutput : public Output {
 public:
  /// Reads the files named by the arguments, and warns of a hand-eye calibration that seems to have
  /// another unit.
  /// Errors: of reading the frame and the grasps; usage (a grasp of a model that is not in the
  /// library).
  ///
  /// request  outlives the output
  static Result<std::unique_ptr<RobotOutput>> open(const OutputArguments& arguments,
                                                   const RecognitionRequest& request,
                                                   const Console& console);

  Result<void> add(const RecognizedScene& scene) override;
  Result<void> finish() override;

 private:
  RobotOutput(std::string file, const Library& library, RobotSetup setup);

  const std::string file_;
  const Library& library_;
  RobotTable table_;
};

}  // namespace trivet::apps
