// SPDX-License-Identifier: Apache-2.0
#include "spu/plugin/plugin_file.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>

#include "spu/plugin/unit_of_plugin.h"

namespace understudy::spu {
namespace {

namespace fs = std::filesystem;

/// lib/understudy of this installation, derived from the path of this program, or of the library in the
/// viewer's process; nothing if the path is unknown.
std::optional<fs::path> libraries_folder() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&libraries_folder), &info) == 0 || info.dli_fname == nullptr)
    return std::nullopt;
  std::error_code error;
  // For a program, dli_fname is only the name that it was started with.
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path object = info.dli_fname;
  if (object.is_absolute() && !fs::equivalent(object, program, error)) return object.parent_path();
  if (program.empty()) return std::nullopt;
  return (program.parent_path() / UNDERSTUDY_LIBRARIES_FROM_PROGRAMS).lexically_normal();
}

bool is_sound(const UnitOption& option) {
  return option.name != nullptr && option.fallback != nullptr && option.help != nullptr &&
         is_value_of(option, option.fallback);
}

}  // namespace

bool names_plugin_file(std::string_view name) {
  return name.find('/') != std::string_view::npos;
}

std::vector<fs::path> plugin_folders() {
  std::vector<fs::path> folders;
  if (const char* named = ::secure_getenv("UNDERSTUDY_PLUGINS")) {
    std::istringstream list(named);
    for (std::string folder; std::getline(list, folder, ':');) {
      if (!folder.empty()) folders.emplace_back(folder);
    }
  }
  if (const auto libraries = libraries_folder()) folders.push_back(*libraries / "plugins");
  return folders;
}

std::optional<fs::path> find_plugin(std::string_view name) {
  for (const fs::path& folder : plugin_folders()) {
    const fs::path file = folder / fmt::format("{}.so", name);
    std::error_code ignored;
    if (fs::is_regular_file(file, ignored)) return fs::absolute(file);
  }
  return std::nullopt;
}

std::vector<fs::path> plugin_files() {
  std::vector<fs::path> files;
  for (const fs::path& folder : plugin_folders()) {
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
      if (entry.path().extension() == ".so") files.push_back(entry.path());
    }
  }
  std::ranges::sort(files, {}, [](const fs::path& file) { return file.filename(); });
  return files;
}

UnitDescription load_plugin(const fs::path& file) {
  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw std::runtime_error(fmt::format("it cannot be loaded: {}", dlerror()));
  auto* const plugin = static_cast<UnitPlugin*>(dlsym(library, "understudy_unit"));
  if (plugin == nullptr)
    throw std::runtime_error(fmt::format("{} exports no `understudy_unit`: it is no unit", file.string()));
  if (plugin->interface != unit_plugin_interface || plugin->commands != dispatch_table_signature)
    throw std::runtime_error(
        fmt::format("{} was built with another version of Understudy, or of the OpenGL registry; build it anew",
                    file.string()));
  if (plugin->name == nullptr || plugin->help == nullptr || plugin->make == nullptr)
    throw std::runtime_error(fmt::format("{} leaves out its name, help or make()", file.string()));
  if (!std::ranges::all_of(plugin->options, is_sound))
    throw std::runtime_error(fmt::format(
        "{} has an option without name, default or help, or whose default is no value of it", file.string()));
  return description_of(*plugin);
}

}  // namespace understudy::spu
