#include "engine/training/ahead_writer.hpp"

#include <utility>

#include "engine/libraries/assemble_library.hpp"

namespace trivet::engine {
namespace {

// Those that wait for a slower one before them; beyond that, they are read again in the end.
constexpr std::uint64_t kMostWaiting = std::uint64_t{256} << 20U;

}  // namespace

Result<void> AheadWriter::add(std::size_t source, std::shared_ptr<PackedModel> model) {
  if (next_ == sources_.size() || source > sources_.back()) return {};
  bytes_waiting_ += packed_bytes(*model);
  waiting_.emplace(source, std::move(model));
  for (; next_ < sources_.size(); ++next_) {
    const auto node = waiting_.extract(sources_[next_]);
    if (!node) break;
    bytes_waiting_ -= packed_bytes(*node.mapped());
    if (const Result<void> written = write(*node.mapped()); !written) return written;
  }
  if (bytes_waiting_ > kMostWaiting) {
    sources_.resize(next_);
    waiting_.clear();
  }
  return {};
}

void AheadWriter::give_up() noexcept {
  sources_.clear();
  next_ = 0;
  waiting_.clear();
  writer_.reset();
  num_written_ = 0;
}

Result<void> AheadWriter::write(PackedModel& model) {
  if (!writer_) {
    Result<LibraryWriter> begun = begin_library(header_, basis_, lock_, names_);
    if (!begun) return begun.error();
    writer_ = std::move(*begun);
  }
  if (const Result<void> added = writer_->add(model); !added) return added;
  ++num_written_;
  return {};
}

std::optional<LibraryWriter> AheadWriter::release() {
  waiting_.clear();
  return std::exchange(writer_, {});
}

}  // namespace trivet::engine
