/// All outputs of a command, filled together.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "apps/recognition/output.hpp"

namespace trivet::apps {

class OutputList {
 public:
  /// Outputs are filled and finished in the order in which they come into the list.
  void push_back(std::unique_ptr<Output> output) { entries_.push_back({std::move(output), {}}); }

  /// Add a scene to each output. An output that fails gets no more scenes, the others do.
  void add(const RecognizedScene& scene);
  void add_failed(const SceneInput& scene, const Error& error);
  /// Finish the outputs one after the other. Errors: the first of adding, in the order of the list,
  /// and then nothing is finished; the first of finishing, and then the outputs behind it are not.
  Result<void> finish();

 private:
  struct Entry {
    std::unique_ptr<Output> output;
    Result<void> added;
  };
  std::vector<Entry> entries_;
};

}  // namespace trivet::apps
