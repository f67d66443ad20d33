// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/desktop/desktop_entry.h"

#include <fmt/format.h>
#include <strings.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <system_error>

namespace understudy::launcher {
namespace {

namespace fs = std::filesystem;

/// Returns whether `viewer` names `entry`: "paraview" names paraview and org.paraview.ParaView.
bool names(const std::string& viewer, const std::string& entry) {
  if (viewer.size() > entry.size()) return false;
  const std::size_t before = entry.size() - viewer.size();
  return strcasecmp(entry.c_str() + before, viewer.c_str()) == 0 && (before == 0 || entry[before - 1] == '.');
}

/// Returns a word of an Exec line, quoted if it contains a reserved character.
std::string exec_word(const std::string& word) {
  constexpr std::string_view reserved = " \t\n\r\"'\\><~|&;$*?#()`";
  std::string doubled;
  for (const char c : word) doubled += c == '%' ? "%%" : std::string(1, c);
  if (!doubled.empty() && doubled.find_first_of(reserved) == std::string::npos) return doubled;
  std::string quoted = "\"";
  for (const char c : doubled) {
    if (c == '"' || c == '`' || c == '$' || c == '\\') quoted += '\\';
    quoted += c;
  }
  // A backslash in a value is written as two.
  std::string written;
  for (const char c : quoted + '"') {
    if (c == '\\') {
      written += "\\\\";
    } else if (c == '\n' || c == '\t' || c == '\r') {
      written += c == '\n' ? "\\n" : c == '\t' ? "\\t" : "\\r";
    } else {
      written += c;
    }
  }
  return written;
}

/// Returns the key of a line "Key=value" or "Key[locale]=value"; empty for any other line.
std::string key_of(const std::string& line) {
  const std::size_t end = line.find_first_of("=[ ");
  return line.empty() || line.front() == '[' || line.front() == '#' || end == std::string::npos
             ? ""
             : line.substr(0, end);
}

bool is_left_out(const std::string& key) {
  return key == "MimeType" || key == "DBusActivatable" || key == "TryExec" || key == "Implements";
}

}  // namespace

std::vector<fs::path> application_folders() {
  std::vector<fs::path> folders;
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value != nullptr ? value : "");
  };
  const std::string home = variable("XDG_DATA_HOME");
  folders.push_back((home.empty() ? fs::path(variable("HOME")) / ".local" / "share" : fs::path(home)) /
                    "applications");
  const std::string shared = variable("XDG_DATA_DIRS");
  std::istringstream list(shared.empty() ? "/usr/local/share:/usr/share" : shared);
  for (std::string folder; std::getline(list, folder, ':');)
    if (!folder.empty()) folders.push_back(fs::path(folder) / "applications");
  return folders;
}

std::optional<fs::path> find_desktop_entry(const std::string& viewer) {
  std::error_code ignored;
  if (viewer.ends_with(".desktop") && fs::is_regular_file(viewer, ignored)) return viewer;
  for (const fs::path& folder : application_folders()) {
    for (const fs::directory_entry& file : fs::directory_iterator(folder, ignored)) {
      if (file.path().extension() != ".desktop") continue;
      if (names(viewer, file.path().stem())) return file.path();
    }
  }
  return std::nullopt;
}

std::string under_understudy(const std::string& entry, const fs::path& understudy,
                             const std::vector<std::string>& options) {
  std::string command = exec_word(understudy) + " run";
  for (const std::string& option : options) command += " " + exec_word(option);
  std::istringstream lines(entry);
  std::string text;
  std::string group;
  bool runs = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('[')) group = line;
    const std::string key = key_of(line);
    if (is_left_out(key)) continue;
    if (key == "Exec") {
      line = fmt::format("Exec={} -- {}", command, line.substr(line.find('=') + 1));
      runs = runs || group == "[Desktop Entry]";
    }
    if (key == "Name" && group == "[Desktop Entry]") line += " (Understudy)";
    text += line;
    text += '\n';
  }
  if (!runs) throw std::runtime_error("not an application entry: there is no line Exec=");
  return text;
}

}  // namespace understudy::launcher
