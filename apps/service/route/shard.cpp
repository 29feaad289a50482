#include "apps/service/route/shard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <chrono>
#include <map>
#include <utility>

#include "apps/service/http/query.hpp"
#include "storage/files/json_file.hpp"

namespace trivet::apps::service {
namespace {

namespace asio = boost::asio;
using tcp = asio::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kPatience{2};
/// A shard that stays ready is asked for its models each so many looks: it may read another
/// library.
constexpr int kCatalogInterval = 10;

Result<ShardCatalog> parse_catalog(const std::string& body) {
  ShardCatalog catalog;
  const Result<void> done =
      with_json(std::as_bytes(std::span(body)), "its models", [&](const JsonNode& root) {
        catalog.unit = root.at("unit").string();
        catalog.models = root.at("models").value();
        for (const JsonNode& model : root.at("models").elements())
          catalog.names.insert(model.at("name").string());
      });
  if (!done) return done.error();
  return catalog;
}

}  // namespace

Result<ShardAddress> parse_shard(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  std::string host = text.substr(0, std::min(colon, text.size()));
  const std::string port = colon == std::string::npos ? "" : text.substr(colon + 1);
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  const std::size_t number = whole_number(port).value_or(0);
  if (host.empty() || number < 1 || number > 65535) {
    return Error{ErrorCode::usage,
                 fmt::format("shards: expected host:port, as 10.0.0.1:8080, found '{}'", text)};
  }
  return ShardAddress{text, std::move(host), port};
}

asio::awaitable<bool> ShardLook::again() {
  std::string reason;
  // A name may lead to another machine by now.
  if (!shard_.is_reachable) reason = co_await resolve();
  bool is_reachable = false, has_read = false;
  if (reason.empty()) {
    const HttpOutcome ready = co_await get("/v2/health/ready");
    if (const HttpFailure* const failure = std::get_if<HttpFailure>(&ready)) {
      reason = failure->reason;
    } else {
      is_reachable = true;
      const unsigned status = std::get<HttpResponse>(ready).status;
      if (status != 200) reason = fmt::format("not ready, with {}", status);
      if (status == 421)
        reason += fmt::format(": start it with --host-name {}", shard_.address.host);
    }
  }
  if (!reason.empty()) num_ready_ = 0;
  if (reason.empty() && num_ready_++ % kCatalogInterval == 0) {
    reason = co_await read_models();
    has_read = reason.empty();
    if (!has_read) num_ready_ = 0;
  }
  shard_.is_reachable = is_reachable;
  shard_.is_ready = reason.empty();
  shard_.reason = std::move(reason);
  co_return has_read;
}

/// Both return why it failed; empty: it did not.
asio::awaitable<std::string> ShardLook::resolve() {
  tcp::resolver resolver(context_);
  error_code error;
  const tcp::resolver::results_type found = co_await resolver.async_resolve(
      shard_.address.host, shard_.address.port, asio::redirect_error(asio::use_awaitable, error));
  if (error || found.empty()) co_return fmt::format("no address: {}", error.message());
  shard_.endpoint = found.begin()->endpoint();
  co_return "";
}

asio::awaitable<std::string> ShardLook::read_models() {
  const HttpOutcome outcome = co_await get("/v1/models");
  const HttpResponse* const answer = std::get_if<HttpResponse>(&outcome);
  if (!answer) co_return std::get<HttpFailure>(outcome).reason;
  if (answer->status == 401)
    co_return "no models, with 401: expected one of its tokens first in the router's --token-file";
  if (answer->status != 200) co_return fmt::format("no models, with {}", answer->status);
  Result<ShardCatalog> catalog = parse_catalog(answer->body);
  if (!catalog) co_return catalog.error().message;
  shard_.catalog = std::move(*catalog);
  co_return "";
}

asio::awaitable<HttpOutcome> ShardLook::get(const std::string& target) {
  HttpCall call{"GET", shard_.address.name, target};
  add_token(call, tokens_.first());
  co_return co_await client_.ask(*shard_.endpoint, call, Clock::now() + kPatience);
}

std::optional<std::string> conflict_of(std::span<const Shard> shards) {
  std::map<std::string, const Shard*> holders;
  const Shard* first = nullptr;
  for (const Shard& shard : shards) {
    if (!shard.catalog) continue;
    if (!first) first = &shard;
    if (shard.catalog->unit != first->catalog->unit) {
      return fmt::format("expected libraries of one unit, found {} in {} and {} in {}",
                         first->catalog->unit, first->address.name, shard.catalog->unit,
                         shard.address.name);
    }
    for (const std::string& name : shard.catalog->names) {
      const auto [holder, is_new] = holders.emplace(name, &shard);
      if (!is_new) {
        return fmt::format("expected each model in one shard, found '{}' in {} and {}", name,
                           holder->second->address.name, shard.address.name);
      }
    }
  }
  return std::nullopt;
}

}  // namespace trivet::apps::service
