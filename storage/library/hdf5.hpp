/// The HDF5 C API behind owning handles. For .cpp files of storage/ only: no public header includes
/// it.
#pragma once

#include <hdf5.h>

#include <utility>

namespace trivet::hdf5 {

/// Prepare the library for this thread. Call before anything else of HDF5.
///
/// Without H5dont_atexit, a file that could not be closed (disk full) crashes the process at its
/// exit. Plugins would load code named by a file. The error printer is a property of the thread.
inline void start() {
  static const bool once = [] {
    H5dont_atexit();
    return H5open() >= 0 && H5PLset_loading_state(0) >= 0;
  }();
  thread_local const bool quiet = H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr) >= 0;
  (void)once;
  (void)quiet;
}

/// Owns one identifier of any kind.
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

/// How a library's file is opened and created: plain system calls and no locks (a published library
/// never changes). The low bound gives checksummed metadata; large datasets begin on a page.
inline Handle file_access() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS));
  const bool ok = H5Pset_fapl_sec2(access.get()) >= 0 &&
                  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110) >= 0 &&
                  H5Pset_alignment(access.get(), 4096, 4096) >= 0 &&
                  H5Pset_file_locking(access.get(), false, true) >= 0;
  return ok ? std::move(access) : Handle();
}

}  // namespace trivet::hdf5
