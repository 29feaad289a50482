/// The library that a service answers with. It is reloaded in the background while the old one
/// answers.
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

/// Files of a library generation.
struct LibraryFiles {
  std::string library;
  OpenOptions options;
};

/// Opens a library and indexes its features. Errors: those of open_recognizer.
Result<std::shared_ptr<const LibraryGeneration>> load_generation(const LibraryFiles& files,
                                                                 std::uint64_t number);

/// Reloads on a separate thread, one reload after the other. After a bad file the old library
/// continues to answer. Once a second it checks whether the library was changed in place, and logs
/// it.
class LibrarySlot {
 public:
  using Done = std::function<void(Result<void>)>;
  /// `service` answers with generation 1 of `files`. All arguments outlive the slot.
  LibrarySlot(LibraryFiles files, RecognitionService& service, Metrics& metrics, RequestLog& log);
  LibrarySlot(const LibrarySlot&) = delete;
  LibrarySlot& operator=(const LibrarySlot&) = delete;
  ~LibrarySlot();

  /// `done` is called on the slot's thread. Requests that arrive while a reload waits share it.
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
  std::uint64_t logged_number_ = 0;  ///< generation whose change was logged
  std::thread thread_;
};

}  // namespace trivet::apps::service
