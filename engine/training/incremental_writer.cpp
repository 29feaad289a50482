#include "engine/training/incremental_writer.hpp"

#include <system_error>
#include <utility>

#include "storage/files/file.hpp"

namespace trivet::engine {
namespace {

// Maximum memory of models that wait for a slower one before them; beyond it, models are stored as
// parts.
constexpr std::uint64_t kMostWaiting = std::uint64_t{256} << 20U;

}  // namespace

// A file without a table of contents would only occupy the disk.
IncrementalWriter::~IncrementalWriter() {
  if (!writer_) return;
  [[maybe_unused]] const Result<void> saved = save_contents();
  writer_.reset();
  std::error_code error;
  if (num_saves_ == 0) std::filesystem::remove(unfinished_, error);
}

Result<PackedModels> IncrementalWriter::add(std::size_t source,
                                            std::shared_ptr<PackedModel> model) {
  if (next_ == sources_.size() || source > sources_.back()) return PackedModels{std::move(model)};
  bytes_waiting_ += packed_bytes(*model);
  waiting_.emplace(source, std::move(model));
  for (; next_ < sources_.size(); ++next_) {
    const auto node = waiting_.extract(sources_[next_]);
    if (!node) break;
    bytes_waiting_ -= packed_bytes(*node.mapped());
    TRIVET_TRY(write(*node.mapped()));
  }
  return bytes_waiting_ > kMostWaiting ? stop() : PackedModels{};
}

Result<PackedModels> IncrementalWriter::give_up() {
  TRIVET_TRY(save_contents());
  writer_.reset();
  num_written_ = 0;
  return stop();
}

Result<void> IncrementalWriter::save_contents() {
  if (num_unsaved_ == 0) return {};
  const Result<void> saved = writer_->write_contents(contents_of(unfinished_, num_saves_));
  if (!saved) return saved;
  ++num_saves_;
  num_unsaved_ = 0;
  time_.reset();
  return {};
}

Result<void> IncrementalWriter::begin() {
  const std::filesystem::path folder = parts_folder(file_);
  TRIVET_TRY(make_folder(folder));
  unfinished_ = free_name(folder);
  TRIVET_TRY_ASSIGN(LibraryWriter begun,
                    LibraryWriter::create_lasting(file_, unfinished_, header_, names_));
  writer_ = std::move(begun);
  time_.reset();
  return writer_->add(basis_);
}

Result<void> IncrementalWriter::write(PackedModel& model) {
  if (!writer_) {
    TRIVET_TRY(begin());
  }
  TRIVET_TRY(writer_->add(model));
  ++num_written_;
  ++num_unsaved_;
  time_.add(model);
  return time_.has_come() ? save_contents() : Result<void>();
}

/// Write no more models.
PackedModels IncrementalWriter::stop() {
  sources_.resize(next_);
  bytes_waiting_ = 0;
  PackedModels waited;
  for (auto& [source, model] : std::exchange(waiting_, {})) waited.push_back(std::move(model));
  return waited;
}

}  // namespace trivet::engine
