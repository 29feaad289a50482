/// A kind of request, and what answers it.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "apps/service/http/call.hpp"

namespace trivet::apps::service {

/// Whether files or the library are others after a request.
enum class Effect : std::uint8_t { reads, changes };

struct Route {
  std::string_view method, path;
  bool is_prefix;  ///< more of the path may follow
  bool is_work;    ///< goes through the queue, and has a body
  Effect effect;
  std::string_view name;  ///< for metrics and the log
  /// Answers, at once or later. rest  what of the path is behind that of the route
  std::function<void(const CallPtr& call, std::string_view rest)> handle;
};

/// The routes of one resource. They refer to the object that they come from.
using Routes = std::vector<Route>;

}  // namespace trivet::apps::service
