/// Preloaded into a program: counts its writes to regular files and its fsyncs, and makes them fail
/// from number FAIL_FROM on (1 is the first), as on a full disk, or only its writes to files in
/// memory if FAIL_IN_MEMORY is set. The count is written to the file COUNT_TO when the program ends.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

std::atomic<long> num_calls{0};

bool is_in_memory(int descriptor) {
  constexpr const char* kPrefix = "/memfd:";
  char link[64], name[64] = {};
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t size = ::readlink(link, name, sizeof name - 1);
  return size > 0 && std::strncmp(name, kPrefix, std::strlen(kPrefix)) == 0;
}

/// Whether this call must fail.
bool fails(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return false;
  static const char* const from = std::getenv("FAIL_FROM");
  static const bool in_memory = std::getenv("FAIL_IN_MEMORY") != nullptr;
  const long call = ++num_calls;
  const bool must_fail =
      in_memory ? is_in_memory(descriptor) : from != nullptr && call >= std::atol(from);
  if (must_fail) errno = ENOSPC;
  return must_fail;
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

[[gnu::destructor]] void write_count() {
  const char* const file = std::getenv("COUNT_TO");
  if (file == nullptr) return;
  if (std::FILE* const out = std::fopen(file, "w")) {
    std::fprintf(out, "%ld", num_calls.load());
    std::fclose(out);
  }
}

}  // namespace

extern "C" {

ssize_t write(int descriptor, const void* bytes, size_t size) {
  static auto* const real = next<ssize_t(int, const void*, size_t)>("write");
  return fails(descriptor) ? -1 : real(descriptor, bytes, size);
}
ssize_t pwrite(int descriptor, const void* bytes, size_t size, off_t at) {
  static auto* const real = next<ssize_t(int, const void*, size_t, off_t)>("pwrite");
  return fails(descriptor) ? -1 : real(descriptor, bytes, size, at);
}
ssize_t pwrite64(int descriptor, const void* bytes, size_t size, off64_t at) {
  static auto* const real = next<ssize_t(int, const void*, size_t, off64_t)>("pwrite64");
  return fails(descriptor) ? -1 : real(descriptor, bytes, size, at);
}
int fsync(int descriptor) {
  static auto* const real = next<int(int)>("fsync");
  return fails(descriptor) ? -1 : real(descriptor);
}

}  // extern "C"
