// SPDX-License-Identifier: Apache-2.0
// The command that starts a node group, from where its ranks are to be.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/understudy/hosts/hostfile.h"
#include "apps/understudy/hosts/mpi_launcher.h"
#include "apps/understudy/hosts/placement.h"
#include "apps/understudy/processes/environment.h"

namespace understudy::launcher {

/// The launcher and its options, for the node's program and its arguments to follow. `folder` is the run's:
/// session files of this machine lie in it, and the file that own_hostfile_text() made.
std::vector<std::string> mpirun_words(const MpiLauncher& launcher, const Placement& placement,
                                      const std::filesystem::path& folder);

/// Of the environment that nodes run in, what mpirun needs.
Environment mpirun_environment(Environment nodes, const Placement& placement,
                               const std::filesystem::path& folder);

/// The file in a run's folder that mpirun_words() names.
std::filesystem::path own_hostfile(const std::filesystem::path& folder);

/// The hosts in it, as this MPI reads them.
std::string own_hostfile_text(MpiFamily family, const std::vector<Host>& hosts);

/// Where the ranks of this machine share memory, if all are on it: a folder in the run's. Must exist.
std::filesystem::path shared_memory_folder(const std::filesystem::path& folder);

/// What starts a program on another host: OMPI_MCA_plm_rsh_agent's words, or those of Open MPI's usual agents.
/// The first of its alternatives ("ssh : rsh") that `is_there`; the first one when none is.
std::vector<std::string> launch_agent(const Environment& environment, bool (*is_there)(const std::string&));

}  // namespace understudy::launcher
