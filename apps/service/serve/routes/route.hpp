/// A kind of request and its handler.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "apps/service/http/call.hpp"

namespace trivet::apps::service {

/// Whether a request may change files or the library.
enum class Effect : std::uint8_t { reads, changes };

struct Route {
  std::string_view method, path;
  bool is_prefix;  ///< the path may continue
  bool is_work;    ///< goes through the queue and has a body
  Effect effect;
  std::string_view name;  ///< name for metrics and the log
  /// Answers, at once or later.
  ///
  /// rest  the path after that of the route
  std::function<void(const CallPtr& call, std::string_view rest)> handle;
};

/// The routes of one resource. They refer to the object that returned them.
using Routes = std::vector<Route>;

}  // namespace trivet::apps::service
