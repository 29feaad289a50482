/// Parts that clients bring to a running service: trained aside as drafts, looked at, published.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "apps/service/common/request_log.hpp"
#include "storage/common/result.hpp"
#include "storage/data/length_unit.hpp"
#include "storage/library/library.hpp"

namespace trivet::apps::service {

struct WorkshopSettings {
  std::string folder;  ///< where drafts lie; empty: nothing is trained
  std::uint32_t max_file_mb = 64;
  std::uint32_t max_seconds = 300;  ///< of training one
  std::uint32_t max_drafts = 100;
  std::uint32_t max_models = 10'000;       ///< of the library
  std::string program = "/proc/self/exe";  ///< that trains, as `trivet train` does
};

enum class DraftState : std::uint8_t { waiting, training, trained, failed };

/// "waiting", "training", "trained", "failed".
std::string_view name_of(DraftState state);

/// A draft as it is now.
struct DraftStatus {
  std::string name, file;
  std::uint64_t num_bytes = 0;
  LengthUnit unit = LengthUnit::meter;
  DraftState state = DraftState::waiting;
  double seconds = 0;            ///< that its training took, or takes until now
  std::string error;             ///< empty: none
  nlohmann::ordered_json facts;  ///< as `trivet train --json` writes them; null before
};

/// A draft is a folder of its own: the file as it came, a manifest of it, and the library of this
/// one model that `trivet train` makes of both, in a process of its own with limits on time and
/// memory. So a damaged or hostile file costs its refusal and nothing else, and drafts outlive the
/// service. All work is done by one thread, in the order in which it was asked for; an exception ends
/// what it was at, and no more. Folders are written and removed that have the marker of their kind, or
/// were not there. Any member may be called from any thread.
class PartWorkshop {
 public:
  using Done = std::function<void(const Result<void>&)>;
  /// Reads the library anew, then calls back.
  using Reload = std::function<void(std::function<void(Result<void>)>)>;

  /// Takes over the drafts of the folder; nothing is done with them before start(). Errors:
  /// cannot_create (also: the folder is not its own), bad_data (the library's parameters are not of
  /// this version).
  ///
  /// library  file that drafts are published into; log outlives the workshop
  static Result<std::unique_ptr<PartWorkshop>> open(WorkshopSettings settings,
                                                    std::filesystem::path library, Reload reload,
                                                    RequestLog& log);
  PartWorkshop(const PartWorkshop&) = delete;
  PartWorkshop& operator=(const PartWorkshop&) = delete;
  ~PartWorkshop();  ///< training is stopped; what waits is answered with an error

  void start();  ///< once: work on what is asked for, and on the drafts

  const WorkshopSettings& settings() const noexcept { return settings_; }

  /// Train a file as a draft, in place of one of the same name.
  ///
  /// name  of the model
  /// file  name that the client gave the file: its extension tells the format
  /// unit  of its coordinates
  /// Errors: usage (the names, too many drafts, those of `refuse_folder`), cannot_create, io (the
  /// disk).
  Result<void> bring(const std::string& name, const std::string& file, LengthUnit unit,
                     std::string_view bytes);
  /// Train a draft again, with a symmetry that is declared, in the library's unit; none: with what
  /// the program finds. Errors: usage (no such draft, not trained), cannot_create, io.
  Result<void> declare(const std::string& name, const std::optional<Symmetry>& symmetry);
  /// Forget a draft, and stop its training. Errors: usage (no such draft).
  Result<void> drop(const std::string& name);
  bool has(const std::string& name) const;  ///< a draft
  /// Why a draft cannot have this name: something lies there that the workshop has not made; none: it
  /// can.
  std::optional<std::string> refuse_folder(const std::string& name) const;

  /// Put a trained draft into the library, in place of a model of the same name, and answer with
  /// it. Errors: usage (not trained, too many models), those of `take_models`, of reading it.
  void publish(const std::string& name, Done done);
  /// Errors: of remove_models, of reading the library.
  void remove(const std::string& model, Done done);
  /// Errors: of rename_model, of reading the library.
  void rename(const std::string& from, const std::string& to, Done done);

  /// All drafts, by name.
  std::vector<DraftStatus> drafts() const;
  /// The library of a trained draft; null: no such one.
  std::shared_ptr<const Library> trained(const std::string& name) const;

 private:
  struct Draft {
    std::string file;
    std::uint64_t num_bytes = 0;
    LengthUnit unit = LengthUnit::meter;
    DraftState state = DraftState::waiting;
    std::chrono::steady_clock::time_point begun{};
    double seconds = 0;
    std::string error;
    nlohmann::ordered_json facts;
    std::shared_ptr<const Library> library;
    std::stop_source stop;
  };
  using Work = std::function<void()>;

  PartWorkshop(WorkshopSettings settings, std::filesystem::path library, Reload reload,
               RequestLog& log, LengthUnit unit, std::vector<std::string> options);
  std::filesystem::path folder_of(const std::string& name) const;
  Result<void> load_drafts();
  void queue_training(const std::string& name);
  Result<void> forget(const std::string& name);
  void remove_folder(const std::string& name) const;
  Result<void> write_manifest_of(const std::string& name, const Draft& draft,
                                 const std::optional<Symmetry>& symmetry) const;
  void train(const std::string& name);
  Result<void> train_and_read(const std::string& name, const std::stop_token& stop,
                              Draft& out) const;
  void change(std::string_view what, const std::string& name, std::function<Result<void>()> edit,
              Done done, std::function<void()> after = {});
  void queue(Work work);
  void run(const std::stop_token& stop);
  void fail_training() noexcept;

  const WorkshopSettings settings_;
  const std::filesystem::path library_;
  const Reload reload_;
  RequestLog& log_;
  const LengthUnit unit_;                   // of the library
  const std::vector<std::string> options_;  // flags that give the library's parameters
  std::mutex files_mutex_;                  // of the folders of drafts
  mutable std::mutex mutex_;                // of what follows
  std::condition_variable changed_;
  std::map<std::string, Draft> drafts_;
  std::deque<Work> work_;
  std::jthread thread_;
};

}  // namespace trivet::apps::service
