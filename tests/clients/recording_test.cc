// SPDX-License-Identifier: Apache-2.0
#include "tests/clients/recording_test.h"

#include <fmt/format.h>

namespace clients {

namespace fs = std::filesystem;

std::string RecordingTest::dump_of(const std::string& recording) const {
  return run_well({"apitrace", "dump", "--color=never", file(recording)}).out;
}

std::string RecordingTest::dump_of_bare(const RecordedLibrary& library, const Words& viewer,
                                        const Environment& environment) const {
  run_well(Words{"apitrace", "trace", "-a", library.api, "-o", file("bare.trace")} + viewer, environment);
  return dump_of("bare.trace");
}

std::string RecordingTest::dump_of_driver(const RecordedLibrary& library, const Words& options,
                                          const Words& viewer, const Environment& environment) const {
  const fs::path recorder = system_libraries / "apitrace/wrappers" / library.wrapper;
  const fs::path drivers = file("drivers");
  fs::create_directory(drivers);
  fs::create_symlink(recorder, drivers / library.name);
  fs::create_symlink(recorder, drivers / "libOpenGL.so.0");
  std::string preload = libraries / "libunderstudy.so";
  for (const fs::path& next :
       {fs::path("libc.so.6"), recorder, system_libraries / library.name, system_libraries / "libOpenGL.so.0"})
    preload += ":" + next.string();
  const Words recorded = {"env", "LD_PRELOAD=" + preload, "UNDERSTUDY_DRIVER_DIR=" + drivers.string(),
                          "TRACE_FILE=" + file("below.trace").string()};
  const Words launcher = under(Words{"--injection", "preload", "--report", file("report.json")} + options);
  const Outcome outcome = run_well(launcher + recorded + viewer, environment);
  fmt::print("{}", outcome.err.substr(outcome.err.rfind("understudy: ")));
  return dump_of("below.trace");
}

}  // namespace clients
