// SPDX-License-Identifier: Apache-2.0
// The names under which applications open OpenGL, and which libraries get the real ones. Shared by the dlopen
// hook and the auditor, which cannot share a library.
#pragma once

#include <limits.h>
#include <stdio.h>
#include <string.h>

namespace understudy::interceptor {

/// The stub libraries in the folder `entry`, by SONAME.
constexpr const char* stub_names[] = {"libGL.so.1", "libGLX.so.0", "libOpenGL.so.0", "libEGL.so.1",
                                      "libOSMesa.so.8"};
constexpr int stub_count = 5;
/// The other four exist wherever OpenGL does. OSMesa does not, and programs probe for it, so its stub is
/// offered only where the real library exists.
constexpr int osmesa_stub = 4;

inline const char* base_name(const char* path) {
  const char* slash = strrchr(path, '/');
  return slash != nullptr ? slash + 1 : path;
}

inline bool starts_with(const char* text, const char* start) {
  return strncmp(text, start, strlen(start)) == 0;
}

/// Returns the position in stub_names of the stub for a requested name; -1 for none. libGL.so, libGL.so.1 and
/// libGL.so.1.7.0 all map to libGL.so.1, with or without a folder in front.
inline int stub_for(const char* requested) {
  const char* base = base_name(requested);
  for (int stub = 0; stub < stub_count; ++stub) {
    const size_t unversioned = strlen(stub_names[stub]) - strlen(".1");
    if (strncmp(base, stub_names[stub], unversioned) != 0) continue;
    const char* version = base + unversioned;
    // Debian has libOSMesa.so.6 as another name of libOSMesa.so.8.
    if (*version == '\0' || (stub == osmesa_stub && *version == '.')) return stub;
    if (!starts_with(version, stub_names[stub] + unversioned)) continue;
    const char* minor = version + strlen(".1");
    if (*minor == '\0' || *minor == '.') return stub;
  }
  return -1;
}

/// Absolute paths of the stubs: written once while the library is loaded, read-only afterwards.
struct StubPaths {
  char path[stub_count][PATH_MAX];  ///< empty if the path is too long

  void set_folder(const char* folder) {
    for (int stub = 0; stub < stub_count; ++stub) {
      const int length = snprintf(path[stub], PATH_MAX, "%s/%s", folder, stub_names[stub]);
      if (length < 0 || length >= PATH_MAX) path[stub][0] = '\0';
    }
  }
};

/// True if `asker` is an OpenGL library or one of ours: its requests are not redirected to a stub. The same
/// holds for everything in `driver_folder` (UNDERSTUDY_DRIVER_DIR, or null), such as a tracer between us and
/// the driver.
inline bool may_have_the_real_one(const char* asker, const char* driver_folder) {
  const char* base = base_name(asker);
  constexpr const char* opengl[] = {"libunderstudy", "libGL.so",      "libGLX",     "libOpenGL.so",
                                    "libEGL",        "libGLdispatch", "libnvidia-", "libOSMesa"};
  for (const char* name : opengl) {
    if (starts_with(base, name)) return true;
  }
  if (driver_folder == nullptr || *driver_folder == '\0') return false;
  const size_t length = strlen(driver_folder);
  return strncmp(asker, driver_folder, length) == 0 && asker[length] == '/';
}

}  // namespace understudy::interceptor
