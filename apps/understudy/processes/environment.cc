// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/processes/environment.h"

#include <unistd.h>

#include <sstream>

#include "spu/options.h"

namespace understudy::launcher {

namespace {

/// Returns whether `folder` is the entry folder, also through a link.
bool is_entry_folder(const std::filesystem::path& folder, const Installation& installation) {
  std::error_code unreadable;
  return folder.lexically_normal() == installation.entry_folder() ||
         std::filesystem::equivalent(folder, installation.entry_folder(), unreadable);
}

}  // namespace

Environment current_environment() {
  Environment environment;
  for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
    const std::string text = *entry;
    if (const auto equals = text.find('='); equals != std::string::npos) {
      environment[text.substr(0, equals)] = text.substr(equals + 1);
    }
  }
  return environment;
}

InjectionSettings settings_of(InjectionMethod injection, const Installation& installation) {
  switch (injection) {
    case InjectionMethod::audit:
      return {"LD_AUDIT", installation.auditor()};
    case InjectionMethod::preload:
      return {"LD_PRELOAD", installation.shim()};
    case InjectionMethod::folder:
      return {"LD_LIBRARY_PATH", installation.entry_folder()};
  }
  return {};
}

void put_in_front(Environment& environment, const std::string& variable, const std::string& entry) {
  std::string& list = environment[variable];
  list = list.empty() ? entry : entry + ":" + list;
}

Environment node_environment(Environment environment, const Installation& installation) {
  environment.erase("LD_AUDIT");
  environment.erase("LD_PRELOAD");
  for (const spu::OptionText& option : spu::option_table()) environment.erase(option.environment);
  if (const auto found = environment.find("LD_LIBRARY_PATH"); found != environment.end()) {
    std::string kept;
    std::istringstream folders(found->second);
    for (std::string folder; std::getline(folders, folder, ':');) {
      if (is_entry_folder(folder, installation)) continue;
      kept += (kept.empty() ? "" : ":") + folder;
    }
    found->second = kept;
    if (kept.empty()) environment.erase(found);
  }
  // mpirun refuses to run as root unless both variables are set; containers often have no other user.
  if (geteuid() == 0) {
    environment["OMPI_ALLOW_RUN_AS_ROOT"] = "1";
    environment["OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"] = "1";
  }
  return environment;
}

std::vector<std::string> as_strings(const Environment& environment) {
  std::vector<std::string> strings;
  strings.reserve(environment.size());
  for (const auto& [name, value] : environment) strings.push_back(name + "=" + value);
  return strings;
}

}  // namespace understudy::launcher
