/// The HDF5 C API with owning handles. For .cpp files of storage/ only: no public header includes
/// it.
#pragma once

#include <hdf5.h>

#include <utility>

namespace trivet::hdf5 {

/// Prepare HDF5 for this thread. Call before any other HDF5 function.
///
/// Without H5dont_atexit, a file that could not be closed (disk full) crashes the process at exit.
/// Plugins would load code that a file names. The error printer is a per-thread setting.
inline void start() {
  static const bool once = [] {
    H5dont_atexit();
    return H5open() >= 0 && H5PLset_loading_state(0) >= 0;
  }();
  thread_local const bool quiet = H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr) >= 0;
  (void)once;
  (void)quiet;
}

/// Owns an HDF5 identifier of any kind.
class Handle {
 public:
  Handle() = default;
  explicit Handle(hid_t id) noexcept : id_(id) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) H5Idec_ref(id_);
  }

  explicit operator bool() const noexcept { return id_ >= 0; }
  hid_t get() const noexcept { return id_; }
  hid_t release() noexcept { return std::exchange(id_, H5I_INVALID_HID); }

 private:
  hid_t id_ = H5I_INVALID_HID;
};

/// Access properties of library files: plain system calls and no locks (a published library never
/// changes). The low version bound gives checksummed metadata; large datasets are page-aligned.
inline Handle file_access() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS));
  const bool ok = H5Pset_fapl_sec2(access.get()) >= 0 &&
                  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110) >= 0 &&
                  H5Pset_alignment(access.get(), 4096, 4096) >= 0 &&
                  H5Pset_file_locking(access.get(), false, true) >= 0;
  return ok ? std::move(access) : Handle();
}

}  // namespace trivet::hdf5
