// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/install_launcher.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "apps/understudy/desktop/desktop_entry.h"
#include "apps/understudy/launch/run_viewer.h"
#include "apps/understudy/launch/say.h"
#include "apps/understudy/processes/installation.h"

namespace understudy::launcher {
namespace {

namespace fs = std::filesystem;

struct InstallArguments {
  std::string viewer;
  bool remove = false;
};

constexpr std::string_view mark = "-understudy";

/// Returns the path of the entry that is made for the viewer's own entry `name`.
fs::path place_of(const std::string& name) {
  return application_folders().front() / fmt::format("{}{}.desktop", name, mark);
}

int remove(const std::string& viewer) {
  // The viewer's own entry may have been removed.
  const auto entry = find_desktop_entry(viewer);
  const auto made = find_desktop_entry(viewer + std::string(mark));
  const fs::path place = entry ? place_of(entry->stem()) : made ? *made : place_of(viewer);
  say(fs::remove(place) ? fmt::format("removed {}", place.string())
                        : fmt::format("{} does not exist", place.string()));
  return 0;
}

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream file(path);
  file << text;
  file.close();
  if (!file)
    throw std::runtime_error(fmt::format("{} cannot be written: {}", path.string(), std::strerror(errno)));
}

int install(const InstallArguments& arguments, const std::vector<std::string>& options) {
  if (arguments.remove) return remove(arguments.viewer);
  const auto entry = find_desktop_entry(arguments.viewer);
  if (!entry) {
    std::string folders;
    for (const fs::path& folder : application_folders()) folders += " " + folder.string();
    say(fmt::format("no menu entry is named {}; searched for .desktop files in{}", arguments.viewer, folders));
    return usage_error;
  }
  if (entry->stem().string().ends_with(mark)) {
    say(fmt::format("{} already starts its viewer under Understudy; give the name of the viewer's own entry",
                    entry->string()));
    return usage_error;
  }
  const fs::path place = place_of(entry->stem());
  std::ifstream file(*entry);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  try {
    write(place, under_understudy(text, this_installation().programs / "understudy", options));
  } catch (const std::runtime_error& error) {
    say(fmt::format("{}: {}", entry->string(), error.what()));
    return 1;
  }
  say(fmt::format("installed {}, which starts the viewer of {} under Understudy", place.string(),
                  entry->string()));
  return 0;
}

}  // namespace

void add_install_launcher(CLI::App& app, const std::vector<std::string>& options,
                          std::function<int()>& chosen) {
  const auto arguments = std::make_shared<InstallArguments>();
  CLI::App* subcommand =
      app.add_subcommand("install-launcher",
                         "adds an entry to the desktop menu that starts a viewer under Understudy: understudy "
                         "install-launcher VIEWER [-- options of run…]");
  subcommand
      ->add_option("viewer", arguments->viewer,
                   "name of the viewer's .desktop file, as paraview for paraview.desktop or "
                   "org.paraview.ParaView.desktop, or the path of the file")
      ->required()
      ->type_name("VIEWER");
  subcommand->add_flag("--remove", arguments->remove, "remove the entry instead of adding it");
  subcommand->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] { return install(*arguments, options); };
  });
}

}  // namespace understudy::launcher
