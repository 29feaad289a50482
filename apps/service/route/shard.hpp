/// A service that holds a part of the library, as the router sees it.
#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "apps/service/http/bearer_tokens.hpp"
#include "apps/service/http/http_client.hpp"
#include "storage/result.hpp"

namespace trivet::apps::service {

struct ShardAddress {
  std::string name;  ///< as it was given: host:port
  std::string host, port;
};

/// Errors: usage (expected host:port, as 10.0.0.1:8080, [::1]:8080 or a name).
Result<ShardAddress> parse_shard(const std::string& text);

/// The models that a shard told of.
struct ShardCatalog {
  std::string unit;
  nlohmann::json models;
  std::set<std::string> names;
};

/// What a shard was when it was last looked at.
struct Shard {
  ShardAddress address;
  std::optional<boost::asio::ip::tcp::endpoint> endpoint{};
  std::optional<ShardCatalog> catalog{};  ///< the last one
  bool is_reachable = false, is_ready = false;
  std::string reason = "not looked at yet";  ///< of not being ready
};

/// Looks at a shard: its address by its name, its readiness, and now and then its models.
class ShardLook {
 public:
  /// All outlive the look.
  ShardLook(boost::asio::io_context& context, HttpClient& client, const BearerTokens& tokens,
            Shard& shard)
      : context_(context), client_(client), tokens_(tokens), shard_(shard) {}

  /// Look and write down what was seen. Returns whether the models were read.
  boost::asio::awaitable<bool> again();

 private:
  boost::asio::awaitable<std::string> resolve();
  boost::asio::awaitable<std::string> read_models();
  boost::asio::awaitable<HttpOutcome> get(const std::string& target);

  boost::asio::io_context& context_;
  HttpClient& client_;
  const BearerTokens& tokens_;
  Shard& shard_;
  int num_ready_ = 0;  // looks since it became ready
};

/// Why shards cannot answer as one: a model that two hold, or units that differ; none: they can.
std::optional<std::string> conflict_of(std::span<const Shard> shards);

}  // namespace trivet::apps::service
