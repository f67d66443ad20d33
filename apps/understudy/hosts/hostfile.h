// SPDX-License-Identifier: Apache-2.0
// Reads Open MPI's hostfiles: one host per line, the number of its ranks, and comments after '#'.
//
//   node1            # one rank, which uses all processors of the host
//   node2 slots=4
//   me@node3 slots=2 max_slots=4
#pragma once

#include <filesystem>
#include <istream>
#include <string>
#include <vector>

namespace understudy::launcher {

struct Host {
  std::string name;  ///< name or address; preceded by "user@" if the launch agent needs it
  int slots = 1;     ///< ranks
};

/// Slots of a host that is named repeatedly are added. A host without slots has one, because each rank uses all
/// processors that it finds. Throws std::runtime_error with one line: `name`, the number of the line, what is
/// wrong there, and what is expected.
std::vector<Host> parse_hostfile(std::istream& text, const std::string& name);

/// The same for a file. The error names the file if it cannot be read.
std::vector<Host> read_hostfile(const std::filesystem::path& file);

/// Returns the hosts in the form of Open MPI's hostfiles.
std::string hostfile_text(const std::vector<Host>& hosts);

/// Returns whether this name or address, with or without "user@", is one of this machine. Names other than
/// those of this machine and its interfaces are resolved, which may wait for a name server.
bool is_this_machine(const std::string& host);

int slots_of(const std::vector<Host>& hosts);

/// Returns, for example, "node1, node2".
std::string names_of(const std::vector<Host>& hosts);

}  // namespace understudy::launcher
