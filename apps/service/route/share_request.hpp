/// What to ask each shard for a request.
#pragma once

#include <chrono>
#include <span>
#include <vector>

#include "apps/service/http/call.hpp"
#include "apps/service/http/http_client.hpp"
#include "apps/service/http/http_server.hpp"
#include "apps/service/http/query.hpp"
#include "apps/service/route/shard.hpp"
#include "storage/result.hpp"

namespace trivet::apps::service {

/// A form may hold options of its own, which the router does not look for; but these it must know.
/// Errors: usage, bad_data.
Result<void> check_form(const HttpRequest& request);

/// The target for each shard; with an empty path: nothing. Models that are asked for by name are
/// asked of the shard that holds them. Errors: usage (no shard does).
Result<std::vector<Target>> targets_of(const Target& asked, std::span<const Shard> shards);

/// A call as a shard gets it, with a token where there is one; it refers to the body of the request.
HttpCall call_of(const Call& call, const Target& target, const Shard& shard,
                 const std::string& token, std::chrono::milliseconds left);

}  // namespace trivet::apps::service
