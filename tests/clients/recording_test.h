// SPDX-License-Identifier: Apache-2.0
// A fixture that records a viewer's calls with apitrace: bare, and on the driver's side of Understudy.
//
// apitrace is designed to be the first library that a program calls, but here it must be the second. Three
// settings achieve this. LD_PRELOAD names Understudy before apitrace's library, and the real OpenGL after it,
// where apitrace looks for the driver (RTLD_NEXT). Between Understudy and apitrace stands the C library, so
// that Understudy finds its dlopen() before apitrace's, which redirects what is opened. UNDERSTUDY_DRIVER_DIR
// is a folder in which the driver's library names link to apitrace's library.
#pragma once

#include <map>
#include <string>

#include "tests/clients/command_test.h"

namespace clients {

/// A window system's library, and the apitrace library that replaces it.
struct RecordedLibrary {
  const char* api;  ///< as in `apitrace trace -a`
  const char* wrapper;
  const char* name;
};

constexpr RecordedLibrary egl{"egl", "egltrace.so", "libEGL.so.1"};
constexpr RecordedLibrary glx{"gl", "glxtrace.so", "libGLX.so.0"};

class RecordingTest : public CommandTest {
 protected:
  using Environment = std::map<std::string, std::string>;

  /// Output of `apitrace dump` for the viewer alone.
  std::string dump_of_bare(const RecordedLibrary& library, const Words& viewer,
                           const Environment& environment) const;

  /// Output for the calls that reach the driver under `understudy run OPTIONS`, which writes its report to
  /// report.json.
  std::string dump_of_driver(const RecordedLibrary& library, const Words& options, const Words& viewer,
                             const Environment& environment) const;

 private:
  std::string dump_of(const std::string& recording) const;
};

}  // namespace clients
