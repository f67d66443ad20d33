// SPDX-License-Identifier: Apache-2.0
// Makes the command that starts a node group, from the placement of its ranks.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/understudy/hosts/hostfile.h"
#include "apps/understudy/hosts/mpi_launcher.h"
#include "apps/understudy/hosts/placement.h"
#include "apps/understudy/processes/environment.h"

namespace understudy::launcher {

/// Returns the launcher and its options, to be followed by the node's program and its arguments. `folder` is
/// the run's; it contains session files of this machine, and the file of own_hostfile_text().
std::vector<std::string> mpirun_words(const MpiLauncher& launcher, const Placement& placement,
                                      const std::filesystem::path& folder);

/// Returns the environment of mpirun, made from the nodes' environment.
Environment mpirun_environment(Environment nodes, const Placement& placement,
                               const std::filesystem::path& folder);

/// The file in the run's folder that mpirun_words() refers to.
std::filesystem::path own_hostfile(const std::filesystem::path& folder);

/// The content of that file, in this MPI's format.
std::string own_hostfile_text(MpiFamily family, const std::vector<Host>& hosts);

/// Folder inside the run's folder for memory that ranks share if all are on this machine. Must exist.
std::filesystem::path shared_memory_folder(const std::filesystem::path& folder);

/// Returns the command that starts a program on another host: from OMPI_MCA_plm_rsh_agent, otherwise Open
/// MPI's default agents. Of its alternatives ("ssh : rsh"), the first for which `is_there` holds; the
/// first one if there is none.
std::vector<std::string> launch_agent(const Environment& environment, bool (*is_there)(const std::string&));

}  // namespace understudy::launcher
