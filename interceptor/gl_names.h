// SPDX-License-Identifier: Apache-2.0
// The names under which applications ask for OpenGL, and who may have the real libraries: known to the dlopen
// hook and to the auditor, which cannot share a library.
#pragma once

#include <limits.h>
#include <stdio.h>
#include <string.h>

namespace understudy::interceptor {

/// The stub libraries in the folder `entry`, by SONAME.
constexpr const char* stub_names[] = {"libGL.so.1", "libGLX.so.0", "libOpenGL.so.0", "libEGL.so.1",
                                      "libOSMesa.so.8"};
constexpr int stub_count = 5;
/// Where there is OpenGL there are the other four, but not everywhere is there OSMesa, and programs ask for it
/// to find out. Its stub is given only where there is a library that it can stand for.
constexpr int osmesa_stub = 4;

inline const char* base_name(const char* path) {
  const char* slash = strrchr(path, '/');
  return slash != nullptr ? slash + 1 : path;
}

inline bool starts_with(const char* text, const char* start) {
  return strncmp(text, start, strlen(start)) == 0;
}

/// Which stub stands for what was asked for, as a position in stub_names; -1 for none. libGL.so, libGL.so.1 and
/// libGL.so.1.7.0 are all libGL.so.1, with or without a folder before them.
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

/// Absolute paths of the stubs: written once, as the library is loaded, and only read after that.
struct StubPaths {
  char path[stub_count][PATH_MAX];  ///< empty where it would not fit

  void set_folder(const char* folder) {
    for (int stub = 0; stub < stub_count; ++stub) {
      const int length = snprintf(path[stub], PATH_MAX, "%s/%s", folder, stub_names[stub]);
      if (length < 0 || length >= PATH_MAX) path[stub][0] = '\0';
    }
  }
};

/// True for the libraries that are OpenGL, or are we: what they ask for is what they get. So does everything in
/// `driver_folder` (UNDERSTUDY_DRIVER_DIR, or null), for instance a tracer that stands between us and the
/// driver.
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
