// SPDX-License-Identifier: Apache-2.0
// Hosts as Open MPI's hostfiles list them: a host a line, how many ranks it takes, comments behind '#'.
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
  std::string name;  ///< name or address, with "user@" in front where the launch agent needs one
  int slots = 1;     ///< ranks
};

/// A host that is named again gets the slots of both lines; one without slots has one, as each rank uses all
/// processors that it finds. Throws std::runtime_error with one line: `name`, the number of the line, what is
/// wrong there, and what is expected.
std::vector<Host> parse_hostfile(std::istream& text, const std::string& name);

/// The same for a file, which is named when it cannot be read.
std::vector<Host> read_hostfile(const std::filesystem::path& file);

/// As Open MPI reads it.
std::string hostfile_text(const std::vector<Host>& hosts);

/// Whether this name or address, with or without "user@", is one of this machine. A name of neither it nor its
/// interfaces is looked up, which may wait for a name server.
bool is_this_machine(const std::string& host);

int slots_of(const std::vector<Host>& hosts);

/// "node1, node2".
std::string names_of(const std::vector<Host>& hosts);

}  // namespace understudy::launcher
