// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/hosts/mpi_launcher.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstdio>
#include <memory>
#include <vector>

#include "apps/understudy/processes/installation.h"

namespace understudy::launcher {

namespace {

/// Returns the first word after `key`; empty if there is no such key.
std::string_view word_after(std::string_view text, std::string_view key) {
  const std::size_t at = text.find(key);
  if (at == std::string_view::npos) return {};
  text.remove_prefix(at + key.size());
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  return text.substr(0, text.find_first_of(" \t\r\n"));
}

std::optional<MpiVersion> version_of(MpiFamily family, const char* name, std::string_view number) {
  int major = 0;
  if (std::from_chars(number.data(), number.data() + number.size(), major).ec != std::errc{}) return {};
  return MpiVersion{family, major, fmt::format("{} {}", name, number)};
}

/// Returns what the program prints for --version, on either output.
std::string said_by(const std::filesystem::path& program) {
  std::string quoted = program.string();
  for (std::size_t at = 0; (at = quoted.find('\'', at)) != std::string::npos; at += 4)
    quoted.replace(at, 1, "'\\''");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> output(
      popen(fmt::format("'{}' --version 2>&1", quoted).c_str(), "r"), pclose);
  std::string said;
  std::array<char, 512> part{};
  while (output && std::fgets(part.data(), part.size(), output.get()) != nullptr) said += part.data();
  return said;
}

struct Family {
  const char* name;
  std::vector<const char*> programs;  ///< names of its launcher, which is not always `mpirun`
  const char* package;
};

Family described(MpiFamily family) {
  if (family == MpiFamily::mpich) return {"MPICH", {"mpirun", "mpirun.mpich", "mpiexec.hydra"}, "mpich"};
  return {"Open MPI", {"mpirun", "mpirun.openmpi"}, "openmpi-bin"};
}

}  // namespace

std::optional<MpiVersion> mpi_version(std::string_view said) {
  if (const std::string_view number = word_after(said, "(Open MPI)"); !number.empty())
    return version_of(MpiFamily::open_mpi, "Open MPI", number);
  if (said.find("HYDRA build details") != std::string_view::npos)
    return version_of(MpiFamily::mpich, "MPICH", word_after(said, "Version:"));
  return {};
}

std::optional<MpiFamily> mpi_of_nodes() {
#if defined(UNDERSTUDY_NODES_USE_OPEN_MPI)
  return MpiFamily::open_mpi;
#elif defined(UNDERSTUDY_NODES_USE_MPICH)
  return MpiFamily::mpich;
#else
  return {};
#endif
}

std::variant<MpiLauncher, std::string> find_mpi_launcher(MpiFamily family) {
  const Family wanted = described(family);
  std::string instead;
  for (const char* name : wanted.programs) {
    const auto program = program_on_path(name);
    if (!program) continue;
    const auto version = mpi_version(said_by(*program));
    if (version && version->family == family) return MpiLauncher{*program, *version};
    if (instead.empty())
      instead = fmt::format("{} is {}", program->string(), version ? version->text : "of a different MPI");
  }
  if (instead.empty()) instead = "mpirun is not on PATH";
  return fmt::format("the nodes were built with {}, which is not installed ({}; apt install {})", wanted.name,
                     instead, wanted.package);
}

}  // namespace understudy::launcher
