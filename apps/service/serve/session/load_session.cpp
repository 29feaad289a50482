#include "apps/service/serve/session/load_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "apps/service/serve/session/session_files.hpp"
#include "storage/files/file.hpp"
#include "storage/library/model_name.hpp"

namespace trivet::apps::service {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxAnswerBytes = 256 << 20;

std::vector<fs::directory_entry> sorted_entries(const fs::path& folder) {
  std::vector<fs::directory_entry> entries;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    entries.push_back(*it);
  std::ranges::sort(entries);
  return entries;
}

class SessionLoader {
 public:
  explicit SessionLoader(const fs::path& folder) : folder_(folder) {}

  SessionContents load() {
    load_files("scans");
    load_files("models");
    if (const std::optional<Manifest> scans = load_listing(kScansFile)) load_scans(*scans);
    if (const std::optional<Manifest> marked = load_listing(kManifestFile)) load_truth(*marked);
    load_runs();
    return std::move(contents_);
  }

 private:
  void report(std::string file, std::string reason) {
    contents_.damaged.push_back({std::move(file), std::move(reason)});
  }

  std::optional<Manifest> load_listing(const char* name);
  void load_scans(const Manifest& scans);
  void load_truth(const Manifest& marked);
  bool is_folder(const std::string& folder);
  void load_files(const std::string& folder);
  void load_file(const std::string& file, const fs::directory_entry& entry);
  void load_runs();
  void load_answer(const std::string& file, const std::string& run, const std::string& scan);

  const fs::path& folder_;
  SessionContents contents_;
};

std::optional<Manifest> SessionLoader::load_listing(const char* name) {
  const fs::path file = folder_ / name;
  const std::optional<std::uint64_t> bytes = regular_file_bytes(file);
  if (!bytes) return std::nullopt;
  Result<Manifest> listing = read_manifest(file);
  if (listing) {
    contents_.files[name] = *bytes;
    return std::move(*listing);
  }
  const std::string new_name = fmt::format("{}.damaged", name);
  std::error_code error;
  fs::rename(file, folder_ / new_name, error);
  report(name, fmt::format("{}; it is kept as {}", listing.error().message, new_name));
  return std::nullopt;
}

/// Whether it is a folder. Reports a link that leads elsewhere.
bool SessionLoader::is_folder(const std::string& folder) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(folder_ / folder, error);
  if (fs::exists(status) && !fs::is_directory(status)) report(folder, "expected a folder");
  return fs::is_directory(status);
}

/// Loads the regular files of a folder. A service that died while it wrote a file has left it under
/// a temporary name.
void SessionLoader::load_files(const std::string& folder) {
  if (!is_folder(folder)) return;
  for (const fs::directory_entry& entry : sorted_entries(folder_ / folder)) {
    const std::string name = entry.path().filename().string();
    if (name.front() != '.') {
      load_file(fmt::format("{}/{}", folder, name), entry);
    } else if (name.ends_with(".tmp")) {
      std::error_code ignored;
      fs::remove(entry.path(), ignored);
    }
  }
}

void SessionLoader::load_file(const std::string& file, const fs::directory_entry& entry) {
  const std::optional<std::uint64_t> bytes = regular_file_bytes(entry.path());
  if (!bytes) {
    report(file, "expected a regular file");
  } else if (!is_model_name(entry.path().stem().string())) {
    report(file, "expected the name of a scan, run or model");
  } else {
    contents_.files[file] = *bytes;
  }
}

void SessionLoader::load_scans(const Manifest& scans) {
  contents_.unit = scans.unit;
  for (const ManifestScene& scene : scans.scenes) {
    const std::string name = scene.file.stem().string();
    if (!is_session_name(name) ||
        scene.name != fmt::format("scans/{}", scene.file.filename().string())) {
      report(kScansFile, fmt::format("expected scans/NAME.EXT, found '{}'", scene.name));
    } else if (!contents_.files.contains(scene.name)) {
      report(scene.name, "the file is not there");
    } else {
      contents_.scans[name].listed = scene;
    }
  }
  for (const auto& [file, bytes] : contents_.files) {
    const auto scan = contents_.scans.find(fs::path(file).stem().string());
    if (file.starts_with("scans/") &&
        (scan == contents_.scans.end() || scan->second.listed.name != file))
      report(file, "scans.json does not say how it is read");
  }
}

void SessionLoader::load_truth(const Manifest& marked) {
  for (const ManifestModel& model : marked.models) {
    if (contents_.files.contains(mesh_file(model.name))) contents_.models[model.name] = model;
  }
  for (const ManifestScene& scene : marked.scenes) {
    const auto scan = contents_.scans.find(scene.file.stem().string());
    if (scan == contents_.scans.end() || scan->second.listed.name != scene.name) {
      report(kManifestFile, fmt::format("no scan '{}'", scene.name));
      continue;
    }
    scan->second.listed.truth = scene.truth;
    scan->second.is_marked = true;
  }
}

void SessionLoader::load_runs() {
  if (!is_folder("runs")) return;
  for (const fs::directory_entry& entry : sorted_entries(folder_ / "runs")) {
    std::error_code error;
    if (!fs::is_directory(fs::symlink_status(entry.path(), error))) continue;
    const std::string run = entry.path().filename().string();
    if (!is_session_name(run)) {
      report(fmt::format("runs/{}", run), "expected the name of a run");
      continue;
    }
    const std::string folder = fmt::format("runs/{}", run);
    load_files(folder);
    for (const auto& [file, bytes] : contents_.files) {
      if (file.starts_with(folder + "/")) load_answer(file, run, fs::path(file).stem().string());
    }
  }
}

void SessionLoader::load_answer(const std::string& file, const std::string& run,
                                const std::string& scan) {
  if (!contents_.scans.contains(scan)) return report(file, fmt::format("no scan '{}'", scan));
  const Result<std::vector<std::byte>> bytes = read_file(folder_ / file, kMaxAnswerBytes);
  if (!bytes) return report(file, bytes.error().message);
  Result<SessionAnswer> answer = read_answer(*bytes, file);
  if (!answer) return report(file, answer.error().message);
  contents_.runs[run][scan] = std::move(*answer);
}

}  // namespace

SessionContents load_session(const fs::path& folder) { return SessionLoader(folder).load(); }

}  // namespace trivet::apps::service
