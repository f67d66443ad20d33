// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/gl_server/client_environment.h"

#include <array>
#include <sstream>
#include <string>

#include "spu/options.h"

namespace understudy::launcher {
namespace {

constexpr auto of_libraries = std::to_array<const char*>({
    "LD_LIBRARY_PATH",
    "UNDERSTUDY_LOG",
    "UNDERSTUDY_PLUGINS",
    "XDG_RUNTIME_DIR",
    // selection and limits of the driver
    "CUDA_VISIBLE_DEVICES",
    "DRI_PRIME",
    "EGL_LOG_LEVEL",
    "EGL_PLATFORM",
    "GALLIUM_DRIVER",
    "GBM_BACKENDS_PATH",
    "LIBGL_ALWAYS_SOFTWARE",
    "LIBGL_DRIVERS_PATH",
    "LP_NATIVE_VECTOR_WIDTH",
    "LP_NUM_THREADS",
    "MESA_EXTENSION_OVERRIDE",
    "MESA_GLSL_VERSION_OVERRIDE",
    "MESA_GL_VERSION_OVERRIDE",
    "MESA_LOADER_DRIVER_OVERRIDE",
    "NVIDIA_VISIBLE_DEVICES",
    "__EGL_VENDOR_LIBRARY_DIRS",
    "__EGL_VENDOR_LIBRARY_FILENAMES",
    // options of sanitizers
    "ASAN_OPTIONS",
    "LSAN_OPTIONS",
    "TSAN_OPTIONS",
    "UBSAN_OPTIONS",
});

/// Variables that contain lists of paths, separated by colons.
constexpr auto places_of_libraries =
    std::to_array<const char*>({"LD_LIBRARY_PATH", "GBM_BACKENDS_PATH", "LIBGL_DRIVERS_PATH",
                                "__EGL_VENDOR_LIBRARY_DIRS", "__EGL_VENDOR_LIBRARY_FILENAMES"});

}  // namespace

Environment client_environment(const Environment& whole) {
  Environment kept;
  const auto keep = [&](const char* name) {
    if (const auto found = whole.find(name); found != whole.end()) kept.insert(*found);
  };
  for (const spu::OptionText& option : spu::option_table()) keep(option.environment);
  for (const char* name : of_libraries) keep(name);
  kept["MESA_SHADER_CACHE_DISABLE"] = "true";
  kept["__GL_SHADER_DISK_CACHE"] = "0";
  return kept;
}

std::vector<std::filesystem::path> folders_of_libraries(const Environment& environment) {
  std::vector<std::filesystem::path> folders;
  for (const char* name : places_of_libraries) {
    const auto found = environment.find(name);
    if (found == environment.end()) continue;
    std::istringstream list(found->second);
    for (std::string path; std::getline(list, path, ':');)
      if (path.starts_with('/')) folders.emplace_back(path);
  }
  return folders;
}

}  // namespace understudy::launcher
