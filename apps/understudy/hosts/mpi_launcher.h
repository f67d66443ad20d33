// SPDX-License-Identifier: Apache-2.0
// Finds the MPI that starts the ranks: it must be the one that the nodes were built with, because only its
// own launcher can start them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace understudy::launcher {

enum class MpiFamily { open_mpi, mpich };

struct MpiVersion {
  MpiFamily family = MpiFamily::open_mpi;
  int major = 4;     ///< of Open MPI; from 5 on, its launcher is PRRTE, which has other options
  std::string text;  ///< "Open MPI 4.1.4"
};

/// Parses the output of `mpirun --version` of Open MPI or Hydra (MPICH); returns none for any other.
std::optional<MpiVersion> mpi_version(std::string_view said);

struct MpiLauncher {
  std::filesystem::path program;
  MpiVersion version;
};

/// The MPI that this build's nodes use; none: no nodes were built.
std::optional<MpiFamily> mpi_of_nodes();

/// Returns the launcher of that family on PATH, or a sentence with what is there instead and what to install.
std::variant<MpiLauncher, std::string> find_mpi_launcher(MpiFamily family);

}  // namespace understudy::launcher
