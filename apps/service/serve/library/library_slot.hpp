/// The library that a service answers with, read anew aside while the old one answers.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "apps/inputs/open_recognizer.hpp"
#include "apps/service/common/request_log.hpp"
#include "apps/service/serve/requests/metrics.hpp"
#include "engine/recognition/recognition_service.hpp"

namespace trivet::apps::service {

/// What a service answers with.
struct LibraryFiles {
  std::string library;
  OpenOptions options;
};

/// Open a library and index its features. Errors: of open_recognizer.
Result<std::shared_ptr<const LibraryGeneration>> load_generation(const LibraryFiles& files,
                                                                 std::uint64_t number);

/// Reads on a thread of its own, one after the other. A bad file leaves the old library answering. Once
/// a second it checks whether others changed the library in place, and says so in the log.
class LibrarySlot {
 public:
  using Done = std::function<void(Result<void>)>;
  /// `service` answers with generation 1 of `files`. What is given outlives the slot.
  LibrarySlot(LibraryFiles files, RecognitionService& service, Metrics& metrics, RequestLog& log);
  LibrarySlot(const LibrarySlot&) = delete;
  LibrarySlot& operator=(const LibrarySlot&) = delete;
  ~LibrarySlot();

  /// `done` is called from the slot's thread. Requests that come while a read waits share it.
  void reload(Done done);

 private:
  void work();
  void load_next(const std::vector<Done>& requests);
  void check_for_change();

  const LibraryFiles files_;
  RecognitionService& service_;
  Metrics& metrics_;
  RequestLog& log_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Done> requests_;
  bool is_closed_ = false;
  std::uint64_t next_number_ = 2;
  std::uint64_t logged_number_ = 0;  ///< of the generation whose change was logged
  std::thread thread_;
};

}  // namespace trivet::apps::service
