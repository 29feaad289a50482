#include "apps/service/serve/library_slot.hpp"

#include <utility>

namespace trivet::apps::service {

Result<std::shared_ptr<const LibraryGeneration>> load_generation(const LibraryFiles& files,
                                                                 std::uint64_t number) {
  Result<Recognizer> recognizer = open_recognizer(files.library, files.options);
  if (!recognizer) return recognizer.error();
  auto generation =
      std::make_shared<LibraryGeneration>(LibraryGeneration{std::move(*recognizer), number});
  // Of a file without an index: no scene waits for it.
  if (const auto indexed = generation->recognizer.features(); !indexed) return indexed.error();
  return std::shared_ptr<const LibraryGeneration>(std::move(generation));
}

LibrarySlot::LibrarySlot(LibraryFiles files, RecognitionService& service, Metrics& metrics)
    : files_(std::move(files)), service_(service), metrics_(metrics), thread_([this] { work(); }) {}

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
    asked_.push_back(std::move(done));
  }
  changed_.notify_all();
}

void LibrarySlot::work() {
  for (;;) {
    std::vector<Done> asked;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return is_closed_ || !asked_.empty(); });
      if (asked_.empty()) return;
      asked.swap(asked_);
    }
    Result<std::shared_ptr<const LibraryGeneration>> next = load_generation(files_, next_number_);
    metrics_.count_reload(next.has_value());
    if (next) {
      service_.publish(std::move(*next));
      ++next_number_;
    }
    for (const Done& done : asked) done(next ? Result<void>() : Result<void>(next.error()));
  }
}

}  // namespace trivet::apps::service
