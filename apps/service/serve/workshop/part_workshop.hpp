/// Parts that clients upload to a running service: trained as drafts in the background, inspected,
/// published.
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
  std::string folder;  ///< folder of drafts; empty: training is off
  std::uint32_t max_file_mb = 64;
  std::uint32_t max_seconds = 300;  ///< time limit of one training
  std::uint32_t max_drafts = 100;
  std::uint32_t max_models = 10'000;       ///< limit of the library
  std::string program = "/proc/self/exe";  ///< executable that trains, as `trivet train` does
};

enum class DraftState : std::uint8_t { waiting, training, trained, failed };

/// The name in JSON: "waiting", "training", "trained" or "failed".
std::string_view name_of(DraftState state);

/// The present state of a draft.
struct DraftStatus {
  std::string name, file;
  std::uint64_t num_bytes = 0;
  LengthUnit unit = LengthUnit::meter;
  DraftState state = DraftState::waiting;
  double seconds = 0;            ///< duration of its training so far
  std::string error;             ///< empty: none
  nlohmann::ordered_json facts;  ///< as written by `trivet train --json`; null before
};

/// Each draft has a folder with the uploaded file, a manifest of it, and the library of this one
/// model that `trivet train` makes of both. The training runs in a separate process with limits on
/// time and memory. So a damaged or hostile file is refused and affects nothing else, and drafts
/// outlive the service. One thread does all work, in the order of the requests; an exception ends
/// only the current item. Only folders that have the marker of their kind, or that did not exist,
/// are written and removed. All members may be called from any thread.
class PartWorkshop {
 public:
  using Done = std::function<void(const Result<void>&)>;
  /// Reloads the library, then calls back.
  using Reload = std::function<void(std::function<void(Result<void>)>)>;

  /// Loads the drafts of the folder; none is processed before start().
  /// Errors: cannot_create (also: the folder is foreign), bad_data (the library's parameters belong
  /// to another version).
  ///
  /// library  file that drafts are published into; log outlives the workshop
  static Result<std::unique_ptr<PartWorkshop>> open(WorkshopSettings settings,
                                                    std::filesystem::path library, Reload reload,
                                                    RequestLog& log);
  PartWorkshop(const PartWorkshop&) = delete;
  PartWorkshop& operator=(const PartWorkshop&) = delete;
  ~PartWorkshop();  ///< stops training; waiting items end with an error

  void start();  ///< Starts to process requests and drafts; call it once.

  const WorkshopSettings& settings() const noexcept { return settings_; }

  /// Trains a file as a draft, replacing one of the same name.
  ///
  /// name  name of the model
  /// file  client's name of the file: its extension gives the format
  /// unit  unit of its coordinates
  /// Errors: usage (the names, too many drafts, those of `refuse_folder`), cannot_create, io (the
  /// disk).
  Result<void> bring(const std::string& name, const std::string& file, LengthUnit unit,
                     std::string_view bytes);
  /// Trains a draft again with a declared symmetry, in the library's unit; none: with the detected
  /// one.
  /// Errors: usage (no such draft, not trained), cannot_create, io.
  Result<void> declare(const std::string& name, const std::optional<Symmetry>& symmetry);
  /// Deletes a draft, and stops its training. Errors: usage (no such draft).
  Result<void> drop(const std::string& name);
  bool has(const std::string& name) const;  ///< there is such a draft
  /// Why a draft cannot have this name: its folder was not made by the workshop; none: it can.
  std::optional<std::string> refuse_folder(const std::string& name) const;

  /// Puts a trained draft into the library, replacing a model of the same name, and calls back with
  /// it.
  /// Errors: usage (not trained, too many models), those of `copy_models`, of reading it.
  void publish(const std::string& name, Done done);
  /// Removes a model. Errors: of remove_models, of reading the library.
  void remove(const std::string& model, Done done);
  /// Renames a model. Errors: of rename_model, of reading the library.
  void rename(const std::string& from, const std::string& to, Done done);

  /// All drafts, by name.
  std::vector<DraftStatus> drafts() const;
  /// The library of a trained draft; null: no such draft.
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
  const LengthUnit unit_;                   // unit of the library
  const std::vector<std::string> options_;  // flags with the library's parameters
  std::mutex files_mutex_;                  // protects the folders of drafts
  mutable std::mutex mutex_;                // protects the following members
  std::condition_variable changed_;
  std::map<std::string, Draft> drafts_;
  std::deque<Work> work_;
  std::jthread thread_;
};

}  // namespace trivet::apps::service
