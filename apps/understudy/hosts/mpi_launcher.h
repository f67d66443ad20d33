// SPDX-License-Identifier: Apache-2.0
// Which MPI starts the ranks: the one that the nodes were built with, as only its own launcher can.
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
  int major = 4;     ///< Open MPI's: from 5 on its launcher is PRRTE's, with other options
  std::string text;  ///< "Open MPI 4.1.4"
};

/// Of what `mpirun --version` says: Open MPI's, Hydra's (MPICH), or another's: none.
std::optional<MpiVersion> mpi_version(std::string_view said);

struct MpiLauncher {
  std::filesystem::path program;
  MpiVersion version;
};

/// The MPI that this build's nodes use; none: there are no nodes.
std::optional<MpiFamily> mpi_of_nodes();

/// The launcher of that family on PATH, or a sentence about what is there instead and what to install.
std::variant<MpiLauncher, std::string> find_mpi_launcher(MpiFamily family);

}  // namespace understudy::launcher
