#include "engine/common/thread_limit.hpp"

#include <tbb/global_control.h>

namespace trivet {

// Constructed in place, since the destruction of a copied original would lift the limit.
struct ThreadLimit::State {
  explicit State(unsigned num_threads)
      : control(tbb::global_control::max_allowed_parallelism, num_threads) {}

  tbb::global_control control;
};

ThreadLimit::ThreadLimit(unsigned num_threads) {
  if (num_threads > 0) state_ = std::make_unique<State>(num_threads);
}

ThreadLimit::~ThreadLimit() = default;

}  // namespace trivet
