#include "apps/service/daemon.hpp"

#include <fmt/format.h>

#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <new>
#include <thread>

namespace trivet::apps::service {
namespace {

using std::chrono::milliseconds;

constexpr std::chrono::seconds kLastAnswers{1};  ///< for clients to take them
constexpr std::chrono::seconds kLastSteps{1};    ///< for threads to end
constexpr milliseconds kLogged{100};             ///< for the last line to be written

}  // namespace

Result<void> Daemon::start(HttpHandler handler) {
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
                  const std::function<void()>& look) {
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(interval);
    if (look) look();
  }
}

void Daemon::drain(const std::function<void()>& set_closing,
                   const std::function<bool(Clock::time_point deadline)>& finish) {
  log_.write("info", "ending");
  set_closing();
  std::this_thread::sleep_for(milliseconds(settings_.drain_grace_ms));
  server_->stop_accepting();
  const auto deadline = Clock::now() + milliseconds(settings_.exit_timeout_ms);
  end_by(deadline + kLastAnswers + kLastSteps);
  if (finish) {
    is_all_answered_ = finish(deadline);
    server_->wait_until_idle(deadline + kLastAnswers);
  } else {
    is_all_answered_ = server_->wait_until_idle(deadline);
  }
  server_->stop();
}

void Daemon::end_by(Clock::time_point last) {
  last_resort_ = std::jthread([this, last](const std::stop_token& stop) {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any ended;
    ended.wait_until(lock, stop, last, [] { return false; });
    if (stop.stop_requested()) return;
    try {
      log_.write("error", "some work did not end: the process ends without it");
      std::this_thread::sleep_for(kLogged);
    } catch (const std::bad_alloc&) {  // ends without a word
    }
    std::_Exit(kExitUnfinished);
  });
}

void Daemon::tell_end() {
  log_.write(is_all_answered_ ? "info" : "warning",
             is_all_answered_ ? "every request was answered" : "some requests were not answered");
}

}  // namespace trivet::apps::service
