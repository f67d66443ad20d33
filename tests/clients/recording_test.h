// SPDX-License-Identifier: Apache-2.0
// A GL server on which apitrace records a viewer's calls: bare, and at the driver's side of Understudy.
//
// apitrace is made to be the first library that a program calls; here it has to be the second. Three settings
// bring that about. LD_PRELOAD names Understudy before apitrace's library and the real OpenGL after it, which
// is where apitrace looks for the driver (RTLD_NEXT). Between them stands the C library, so that Understudy
// finds its dlopen() before apitrace's, which changes what is opened. UNDERSTUDY_DRIVER_DIR is a folder in
// which the driver's names lead to apitrace's library.
#pragma once

#include <map>
#include <string>

#include "tests/clients/command_test.h"

namespace clients {

/// A window system's library, and apitrace's in its place.
struct RecordedLibrary {
  const char* api;  ///< as `apitrace trace -a` has it
  const char* wrapper;
  const char* name;
};

constexpr RecordedLibrary egl{"egl", "egltrace.so", "libEGL.so.1"};
constexpr RecordedLibrary glx{"gl", "glxtrace.so", "libGLX.so.0"};

class RecordingTest : public CommandTest {
 protected:
  using Environment = std::map<std::string, std::string>;

  /// What `apitrace dump` says of the viewer alone.
  std::string dump_of_bare(const RecordedLibrary& library, const Words& viewer,
                           const Environment& environment) const;

  /// What it says of the calls that reach the driver under `understudy run OPTIONS`, whose report is left in
  /// report.json.
  std::string dump_of_driver(const RecordedLibrary& library, const Words& options, const Words& viewer,
                             const Environment& environment) const;

 private:
  std::string dump_of(const std::string& recording) const;
};

}  // namespace clients
