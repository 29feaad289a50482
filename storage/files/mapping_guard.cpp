#include "storage/files/mapping_guard.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>

namespace trivet {
namespace {

/// Range of a guarded mapping. A signal handler may read it at any time, so it has no lock.
struct Guarded {
  std::atomic<bool> is_used{false}, is_torn{false};
  std::atomic<std::uintptr_t> begin{0}, end{0};  ///< 0: none
  std::atomic<std::atomic<PieceState>*> pieces{nullptr};
};
static_assert(std::atomic<std::uintptr_t>::is_always_lock_free);

std::array<Guarded, 4096> all_guarded;
std::atomic<std::size_t> num_slots{0};  ///< number of slots used so far
std::uintptr_t page_size = 0;
struct sigaction action_before {};

/// Mark a piece as torn, unless it was copied or is being copied.
bool mark_torn(std::atomic<PieceState>& piece) noexcept {
  PieceState expected = PieceState::of_file;
  return piece.compare_exchange_strong(expected, PieceState::torn) || expected == PieceState::torn;
}

/// Replace the rest of a guarded mapping from an address on, up to the next copied piece: past the end
/// of a truncated file there is no data, and the mapping is reported as torn as a whole. The rest is
/// replaced at once, since each page would count towards the limit on mappings of a process.
bool tear(std::uintptr_t address) noexcept {
  const std::size_t n = num_slots.load(std::memory_order_acquire);
  for (std::size_t i = 0; i < n; ++i) {
    Guarded& guarded = all_guarded[i];
    const std::uintptr_t begin = guarded.begin.load(std::memory_order_acquire);
    const std::uintptr_t end = guarded.end.load(std::memory_order_acquire);
    if (begin == 0 || address < begin || address >= end ||
        guarded.begin.load(std::memory_order_acquire) != begin)
      continue;
    guarded.is_torn.store(true, std::memory_order_release);
    const std::uintptr_t page = address / page_size * page_size;
    std::atomic<PieceState>* const pieces = guarded.pieces.load(std::memory_order_acquire);
    std::size_t piece = (page - begin) / MappingGuard::kPieceBytes;
    const auto begin_of = [&](std::size_t k) {
      return std::min(end, begin + k * MappingGuard::kPieceBytes);
    };
    // The access is repeated on return: it then reads the copy.
    if (!mark_torn(pieces[piece++])) return true;
    while (begin_of(piece) < end && mark_torn(pieces[piece])) ++piece;
    return ::mmap(reinterpret_cast<void*>(page), begin_of(piece) - page, PROT_READ,
                  MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) != MAP_FAILED;
  }
  return false;
}

void on_bus_error(int signal, siginfo_t* info, void* context) {
  const int error = errno;
  const bool is_torn =
      info->si_code == BUS_ADRERR && tear(reinterpret_cast<std::uintptr_t>(info->si_addr));
  errno = error;
  if (is_torn) return;
  if ((action_before.sa_flags & SA_SIGINFO) != 0) {
    return action_before.sa_sigaction(signal, info, context);
  }
  if (action_before.sa_handler != SIG_DFL && action_before.sa_handler != SIG_IGN) {
    return action_before.sa_handler(signal);
  }
  // The access is repeated on return and then ends the process.
  struct sigaction end {};
  end.sa_handler = SIG_DFL;
  ::sigaction(SIGBUS, &end, nullptr);
}

void install_handler() {
  page_size = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  ::sigaction(SIGBUS, nullptr, &action_before);
  struct sigaction action {};
  action.sa_sigaction = on_bus_error;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  ::sigaction(SIGBUS, &action, nullptr);
}

}  // namespace

MappingGuard::MappingGuard(std::span<const std::byte> mapped,
                           std::span<std::atomic<PieceState>> pieces) {
  static const bool installed = (install_handler(), true);
  (void)installed;
  for (std::size_t i = 0; i < all_guarded.size(); ++i) {
    Guarded& guarded = all_guarded[i];
    if (guarded.is_used.load(std::memory_order_relaxed) || guarded.is_used.exchange(true)) continue;
    std::size_t n = num_slots.load();
    while (n < i + 1 && !num_slots.compare_exchange_weak(n, i + 1)) {
    }
    const auto begin = reinterpret_cast<std::uintptr_t>(mapped.data());
    guarded.is_torn.store(false);
    guarded.pieces.store(pieces.data());
    guarded.end.store(begin + mapped.size());
    guarded.begin.store(begin);
    slot_ = i;
    return;
  }
}

MappingGuard::~MappingGuard() {
  if (slot_ == kNone) return;
  Guarded& guarded = all_guarded[slot_];
  guarded.begin.store(0);
  guarded.end.store(0);
  guarded.is_used.store(false);
}

bool MappingGuard::is_torn() const noexcept {
  return slot_ != kNone && all_guarded[slot_].is_torn.load(std::memory_order_acquire);
}

}  // namespace trivet
