#include "apps/service/daemon.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <new>
#include <thread>

#include "apps/service/http/http_messages.hpp"

namespace trivet::apps::service {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLastAnswers{1000};  ///< time for clients to receive the last responses
constexpr milliseconds kLastSteps{1000};    ///< time for threads to end
constexpr milliseconds kLogged{100};        ///< time for the last line to be written

std::atomic<bool> sighup_pending{false};

}  // namespace

void Daemon::handle_sighup() {
  std::signal(SIGHUP, [](int) { sighup_pending = true; });
}

bool Daemon::received_sighup() { return sighup_pending.exchange(false); }

Result<void> Daemon::read_tokens() {
  if (settings_.token_file.empty()) return {};
  Result<TokenFile> file = read_token_file(settings_.token_file);
  if (!file) {
    log_.write("error", "tokens not reloaded", {{"error", file.error().message}});
    return file.error();
  }
  if (file->is_readable_by_others) {
    log_.write("warning", "tokens can be read by others: chmod o-r",
               {{"file", settings_.token_file}});
  }
  tokens_.set(std::move(file->tokens));
  return {};
}

std::optional<HttpResponse> Daemon::refuse(const HttpRequest& head, bool is_free,
                                           const std::function<void(AccessFault)>& count) {
  const std::optional<AccessRefusal> refusal = access_.refuse(head, is_free);
  if (!refusal) return std::nullopt;
  count(refusal->fault);
  const std::string id = request_id(head);
  log_.write("info", "request refused",
             {{"request_id", id},
              {"method", head.method},
              {"refusal", name_of(refusal->fault)},
              {"code", refusal->status},
              {"error", refusal->reason}});
  HttpResponse response = refusal->response();
  response.headers.emplace_back("X-Request-Id", id);
  return response;
}

Result<void> Daemon::start(HttpHandler handler) {
  TRIVET_TRY(read_tokens());
  Result<HttpServer> started = HttpServer::start(
      settings_.address, settings_.port, settings_.http(max_arriving_mb_), std::move(handler));
  if (!started) return started.error();
  server_ = std::move(*started);
  listening_ = &*server_;
  return {};
}

std::size_t Daemon::num_connections() const {
  const HttpServer* const server = listening_;
  return server ? server->num_connections() : 0;
}

std::string Daemon::url() const {
  return fmt::format("http://{}:{}", settings_.address, server_->port());
}

void Daemon::wait(const std::stop_token& stop, milliseconds interval,
                  const std::function<void()>& callback) {
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(interval);
    callback();
  }
}

void Daemon::drain(const std::function<void()>& set_closing,
                   const std::function<bool(Clock::time_point deadline)>& finish) {
  log_.write("info", "ending");
  set_closing();
  std::this_thread::sleep_for(milliseconds(settings_.drain_grace_ms));
  server_->stop_accepting();
  const milliseconds timeout(settings_.exit_timeout_ms);
  const auto end = Clock::now() + timeout, last_answers = end - std::min(kLastSteps, timeout / 4),
             deadline = last_answers - std::min(kLastAnswers, timeout / 4);
  end_by(end);
  is_all_answered_ = finish(deadline);
  server_->wait_until_idle(last_answers);
  server_->stop();
}

void Daemon::end_by(Clock::time_point last) {
  last_resort_ = std::jthread([this, last](const std::stop_token& stop) {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any ended;
    ended.wait_until(lock, stop, last - kLogged, [] { return false; });
    if (stop.stop_requested()) return;
    try {
      log_.write("error", "some work did not end: the process ends without it");
      std::this_thread::sleep_for(kLogged);
    } catch (const std::bad_alloc&) {  // ends without a message
    }
    std::_Exit(kExitUnfinished);
  });
}

void Daemon::log_end() {
  log_.write(is_all_answered_ ? "info" : "warning",
             is_all_answered_ ? "every request was answered" : "some requests were not answered");
}

}  // namespace trivet::apps::service
