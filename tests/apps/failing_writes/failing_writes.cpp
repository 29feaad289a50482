/// Preloaded into a program: counts its writes to regular files and its fsyncs, and makes them fail
/// from number FAIL_FROM on (1 is the first), as on a full disk. The count is written to the file
/// COUNT_TO when the program ends.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>

namespace {

std::atomic<long> num_calls{0};

/// Whether this call must fail.
bool fails(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return false;
  static const char* const from = std::getenv("FAIL_FROM");
  const long call = ++num_calls;
  if (from == nullptr || call < std::atol(from)) return false;
  errno = ENOSPC;
  return true;
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
