#include "apps/service/serve/library/library_slot.hpp"

#include <fmt/format.h>

#include <chrono>
#include <exception>
#include <new>
#include <utility>

#include "storage/common/wait_for_memory.hpp"

namespace trivet::apps::service {
namespace {

constexpr std::chrono::seconds kCheckInterval{1};

}  // namespace

Result<std::shared_ptr<const LibraryGeneration>> load_generation(const LibraryFiles& files,
                                                                 std::uint64_t number) {
  Result<Recognizer> recognizer = open_recognizer(files.library, files.options);
  if (!recognizer) return recognizer.error();
  auto generation =
      std::make_shared<LibraryGeneration>(LibraryGeneration{std::move(*recognizer), number});
  // Computed now, so that no scene waits for it; the features of a file without an index, too.
  TRIVET_TRY(generation->recognizer.features());
  generation->recognizer.make_ready();
  return std::shared_ptr<const LibraryGeneration>(std::move(generation));
}

LibrarySlot::LibrarySlot(LibraryFiles files, RecognitionService& service, Metrics& metrics,
                         RequestLog& log)
    : files_(std::move(files)), service_(service), metrics_(metrics), log_(log), thread_([this] {
        work();
      }) {}

LibrarySlot::~LibrarySlot() {
  {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void LibrarySlot::reload(Done done) {
  {
    const std::lock_guard lock(mutex_);
    requests_.push_back(std::move(done));
  }
  changed_.notify_all();
}

void LibrarySlot::work() {
  wait_for_memory_on_this_thread();
  for (;;) {
    std::vector<Done> requests;
    {
      std::unique_lock lock(mutex_);
      changed_.wait_for(lock, kCheckInterval, [&] { return is_closed_ || !requests_.empty(); });
      if (is_closed_ && requests_.empty()) return;
      requests.swap(requests_);
    }
    if (!requests.empty()) load_next(requests);
    check_for_change();
  }
}

void LibrarySlot::load_next(const std::vector<Done>& requests) {
  const auto next = [&]() -> Result<std::shared_ptr<const LibraryGeneration>> {
    try {
      return load_generation(files_, next_number_);
    } catch (const std::bad_alloc&) {
      return Error{ErrorCode::no_memory, fmt::format("{}: {}", files_.library, kOutOfMemory)};
    } catch (const std::exception& error) {
      return Error{ErrorCode::internal, error.what()};
    }
  }();
  metrics_.count_reload(next.has_value());
  if (next) {
    service_.publish(*next);
    ++next_number_;
  }
  for (const Done& done : requests) done(next ? Result<void>() : Result<void>(next.error()));
}

void LibrarySlot::check_for_change() {
  try {
    const auto generation = service_.generation();
    if (generation->number == logged_number_) return;
    const Result<void> same = generation->recognizer.library().unchanged();
    if (same) return;
    log_.write("error", "library changed", {{"error", same.error().message}});
    logged_number_ = generation->number;
  } catch (const std::exception&) {
    // Out of memory for the log entry: try again in a second.
  }
}

}  // namespace trivet::apps::service
