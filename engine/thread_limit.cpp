#include <tbb/global_control.h>

#include "engine/progress.hpp"

namespace trivet {

struct ThreadLimit::State {
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(unsigned num_threads) {
  if (num_threads > 0) {
    state_ = std::make_unique<State>(
        State{tbb::global_control(tbb::global_control::max_allowed_parallelism, num_threads)});
  }
}

ThreadLimit::~ThreadLimit() = default;

}  // namespace trivet
