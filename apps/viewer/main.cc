// SPDX-License-Identifier: Apache-2.0
// The bundled volume viewer.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <new>

#include "apps/viewer/formats/volume_file.h"
#include "apps/viewer/model/error.h"
#include "apps/viewer/offscreen.h"
#include "apps/viewer/options.h"
#include "apps/viewer/window.h"

namespace {

int fail(viewer::ExitCode code, const char* message) {
  std::fflush(stdout);
  fmt::print(stderr, "understudy-viewer: {}\n", message);
  return static_cast<int>(code);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    viewer::Options options;
    if (const std::optional<int> status = viewer::parse_command_line(argc, argv, options)) return *status;
    viewer::Volume volume = viewer::load_volume(options.volume_path, options.hints);
    if (options.offscreen)
      viewer::run_offscreen(options, std::move(volume));
    else
      viewer::run_window(options, std::move(volume));
    return static_cast<int>(viewer::ExitCode::success);
  } catch (const viewer::Error& error) {
    return fail(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    return fail(viewer::ExitCode::bad_file,
                "out of memory; downsample the volume, or use --mode table instead of rgba");
  } catch (const std::exception& error) {
    return fail(viewer::ExitCode::bad_file, error.what());
  }
}
