/// All outputs of a command, filled together.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "apps/recognition/output.hpp"

namespace trivet::apps {

class OutputList {
 public:
  /// Adds an output. Outputs are filled and finished in the order of the list.
  void push_back(std::unique_ptr<Output> output) { entries_.push_back({std::move(output), {}}); }

  /// Adds a scene to each output. An output that fails gets no more scenes; the others do.
  void add(const RecognizedScene& scene);
  void add_failed(const SceneInput& scene, const Error& error);
  /// Finishes the outputs one after the other.
  /// Errors: the first error of adding, in the order of the list, and then nothing is finished;
  /// else the first error of finishing, and then the following outputs are not finished.
  Result<void> finish();

 private:
  struct Entry {
    std::unique_ptr<Output> output;
    Result<void> added;
  };
  std::vector<Entry> entries_;
};

}  // namespace trivet::apps
