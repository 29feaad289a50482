#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "apps/commands/commands.hpp"
#include "apps/results/json_output.hpp"
#include "apps/results/standard_output.hpp"
#include "apps/service/http/bearer_tokens.hpp"
#include "apps/service/http/http_client.hpp"
#include "storage/file.hpp"

namespace trivet::apps {
namespace {

using namespace service;

namespace asio = boost::asio;
using tcp = asio::ip::tcp;
using Clock = std::chrono::steady_clock;
using boost::system::error_code;

constexpr std::uint64_t kMaxSceneBytes = 256ULL << 20;
constexpr int kSearchSteps = 5;

struct LoadArguments {
  std::vector<std::string> scenes;
  std::string address = "127.0.0.1", query, json, token_file, token;
  std::uint16_t port = 8080;
  double rate = 1, seconds = 10, timeout = 30, max_p99 = 0;
};

Clock::duration duration_of(double seconds) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

/// Of rising numbers; NaN without any.
double quantile(const std::vector<double>& rising, double share) {
  if (rising.empty()) return std::nan("");
  const auto place =
      static_cast<std::size_t>(std::ceil(share * static_cast<double>(rising.size())));
  return rising[std::max<std::size_t>(place, 1) - 1];
}

/// What became of the requests of one run.
struct LoadResult {
  double rate = 0;  ///< asked for [1/s]
  /// Seconds of answers with 200 and with 503, rising, from when each was due.
  std::vector<double> good, refused;
  std::map<int, std::size_t> codes;  ///< of all; 0: no answer
  double seconds = 0;                ///< until the last answer

  double quantile(double share) const { return apps::quantile(good, share); }
  double goodput() const { return static_cast<double>(good.size()) / seconds; }
};

/// A request that is sent again and again.
struct LoadScene {
  std::string body;
  std::string target;
};

/// Sends requests when they are due, whatever became of those before: an open loop, in which a slow
/// answer holds up no other request and its wait counts in full. Each has a connection of its own,
/// as a new client would, so that none leans on those before.
class LoadRun {
 public:
  LoadRun(const LoadArguments& arguments, const tcp::endpoint& where,
          std::span<const LoadScene> scenes)
      : arguments_(arguments), where_(where), scenes_(scenes) {}

  LoadResult run(double rate) {
    result_.rate = rate;
    const auto start = Clock::now();
    asio::co_spawn(context_, send_all(start), asio::detached);
    context_.run();
    result_.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    std::ranges::sort(result_.good);
    std::ranges::sort(result_.refused);
    return std::move(result_);
  }

 private:
  asio::awaitable<void> send_all(Clock::time_point start) {
    asio::steady_timer timer(context_);
    const auto n = static_cast<std::size_t>(std::ceil(result_.rate * arguments_.seconds));
    for (std::size_t i = 0; i < n; ++i) {
      const auto due = start + duration_of(static_cast<double>(i) / result_.rate);
      timer.expires_at(due);
      error_code ignored;
      co_await timer.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
      asio::co_spawn(context_, send_one(scenes_[i % scenes_.size()], due), asio::detached);
    }
  }

  asio::awaitable<void> send_one(const LoadScene& scene, Clock::time_point due) {
    HttpCall call{
        "POST", arguments_.address, scene.target, {}, std::as_bytes(std::span(scene.body))};
    add_token(call, arguments_.token);
    const HttpOutcome outcome =
        co_await client_.ask(where_, call, Clock::now() + duration_of(arguments_.timeout));
    const HttpResponse* const answer = std::get_if<HttpResponse>(&outcome);
    const int code = answer ? static_cast<int>(answer->status) : 0;
    const double seconds = std::chrono::duration<double>(Clock::now() - due).count();
    ++result_.codes[code];
    if (code == 200) result_.good.push_back(seconds);
    if (code == 503) result_.refused.push_back(seconds);
  }

  const LoadArguments& arguments_;
  tcp::endpoint where_;
  std::span<const LoadScene> scenes_;
  asio::io_context context_{1};
  // Connecting has the time of the whole.
  HttpClient client_{context_,
                     {.connect_timeout = std::chrono::duration_cast<std::chrono::milliseconds>(
                          duration_of(arguments_.timeout))}};
  LoadResult result_;
};

std::string line_of(const LoadResult& result) {
  std::string codes;
  for (const auto& [code, n] : result.codes) {
    codes += fmt::format("{}{} {}", codes.empty() ? "" : ", ", n,
                         code == 0 ? std::string("without answer") : fmt::format("with {}", code));
  }
  const std::string refused =
      result.refused.empty() ? ""
                             : fmt::format("; 503 p99 {:.3f} s, slowest {:.3f}",
                                           quantile(result.refused, 0.99), result.refused.back());
  return fmt::format(
      "{:.2f} /s asked, {:.2f} /s answered; p50 {:.3f} s, p90 {:.3f}, p99 {:.3f}, p99.9 {:.3f}; "
      "{}{}\n",
      result.rate, result.goodput(), result.quantile(0.5), result.quantile(0.9),
      result.quantile(0.99), result.quantile(0.999), codes, refused);
}

nlohmann::ordered_json json_of(const LoadResult& result) {
  nlohmann::ordered_json codes;
  for (const auto& [code, n] : result.codes) codes[std::to_string(code)] = n;
  return {{"rate", result.rate},
          {"goodput", result.goodput()},
          {"seconds", result.seconds},
          {"p50", result.quantile(0.5)},
          {"p90", result.quantile(0.9)},
          {"p99", result.quantile(0.99)},
          {"p99_9", result.quantile(0.999)},
          {"p99_503", quantile(result.refused, 0.99)},
          {"slowest_503", quantile(result.refused, 1)},
          {"codes", std::move(codes)}};
}

/// Whether a rate was borne: every request answered, and in time.
bool is_borne(const LoadResult& result, double max_p99) {
  return result.codes.size() == 1 && result.codes.contains(200) && result.quantile(0.99) <= max_p99;
}

Result<void> load(LoadArguments& arguments, const Context& context) {
  error_code error;
  const asio::ip::address address = asio::ip::make_address(arguments.address, error);
  if (error) {
    return Error{ErrorCode::usage,
                 fmt::format("--address: expected an IP address as 127.0.0.1, found '{}'",
                             arguments.address)};
  }
  if (!arguments.token_file.empty()) {
    const Result<TokenFile> file = read_token_file(arguments.token_file);
    if (!file) return file.error();
    arguments.token = file->tokens.front();
  }
  std::vector<LoadScene> scenes;
  for (const std::string& file : arguments.scenes) {
    Result<std::string> body = read_text_file(file, kMaxSceneBytes);
    if (!body) return body.error();
    std::string extension = std::filesystem::path(file).extension().string();
    if (!extension.empty()) extension.erase(0, 1);
    scenes.push_back({std::move(*body), "/v1/recognize?format=" + extension +
                                            (arguments.query.empty() ? "" : "&") +
                                            arguments.query});
  }

  nlohmann::ordered_json runs = nlohmann::ordered_json::array();
  Result<void> told;
  const auto run = [&](double rate) {
    LoadResult result = LoadRun(arguments, {address, arguments.port}, scenes).run(rate);
    if (told) told = write_output(line_of(result));
    runs.push_back(json_of(result));
    return result;
  };
  LoadResult result = run(arguments.rate);
  if (result.codes.contains(0) && result.codes.size() == 1) {
    return Error{ErrorCode::io,
                 fmt::format("{}:{}: no request was answered", arguments.address, arguments.port)};
  }
  if (arguments.max_p99 > 0) {
    // Twice the rate until it is too much, then halve the gap.
    double borne = 0, rate = arguments.rate;
    while (is_borne(result, arguments.max_p99) && !context.stop.stop_requested()) {
      borne = rate;
      result = run(rate *= 2);
    }
    for (int i = 0; i < kSearchSteps && !context.stop.stop_requested(); ++i) {
      const double middle = (borne + rate) / 2;
      (is_borne(run(middle), arguments.max_p99) ? borne : rate) = middle;
    }
    if (told) {
      told = write_output(fmt::format("highest rate with p99 within {:g} s: {:.2f} /s\n",
                                      arguments.max_p99, borne));
    }
  }
  if (!told) return told;
  if (arguments.json.empty()) return {};
  return write_json(arguments.json, {{"runs", std::move(runs)}});
}

}  // namespace

void add_load(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<LoadArguments>();
  CLI::App* command = app.add_subcommand(
      "load",
      "Measure a service under load\n\n"
      "Requests are sent at a fixed rate, whether those before have been answered or not, and "
      "times\n"
      "count from when a request was due: a service that is too slow cannot hide it.");
  command->add_option("SCENE", arguments->scenes, "Scans that the requests send in turn")
      ->required();
  command->add_option("--address", arguments->address, "Of the service")->capture_default_str();
  command->add_option("--port", arguments->port, "Of the service")->capture_default_str();
  command->add_option("--token-file", arguments->token_file,
                      "Show the first of these bearer tokens, as the service asks for");
  command->add_option("--query", arguments->query,
                      "Parameters of the requests, as method=ppf&camera=572,572,320,240,0.0001");
  command->add_option("--rate", arguments->rate, "Requests a second")
      ->check(CLI::Range(0.001, 100'000.0))
      ->capture_default_str();
  command->add_option("--seconds", arguments->seconds, "Length of a run")
      ->check(CLI::Range(0.1, 86'400.0))
      ->capture_default_str();
  command->add_option("--timeout", arguments->timeout, "For an answer [s]")
      ->check(CLI::Range(0.001, 3600.0))
      ->capture_default_str();
  command->add_option("--max-p99", arguments->max_p99,
                      "Find the highest rate, from --rate on, at which every request is answered "
                      "and 99 % within so many seconds");
  command->add_option("--json", arguments->json,
                      "Write the runs as JSON to this file, - for standard output");
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return load(*arguments, context); };
  });
}

}  // namespace trivet::apps
