// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/hosts/mpirun_command.h"

#include <fmt/format.h>

#include <sstream>

namespace understudy::launcher {
namespace {

using Words = std::vector<std::string>;

void append(Words& words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
}

/// Options for Open MPI before 5, whose launcher is ORTE.
Words launch_by_orte(const Placement& placement, const std::filesystem::path& folder) {
  switch (placement.launch) {
    case Launch::this_machine:
      return {// Neither a remote shell nor a network device is needed.
              "--mca", "plm", "isolated", "--mca", "btl", "self,vader",
              // Ranks are not put onto the nodes of an allocation, to which a login node does not belong.
              "--mca", "ras", "^slurm",
              // Session files are removed with the run's folder in any case, and so is the memory that ranks
              // share, which would stay in /dev/shm when mpirun is killed.
              "--mca", "orte_tmpdir_base", folder.string(), "--mca", "btl_vader_backing_directory",
              shared_memory_folder(folder).string()};
    case Launch::remote_shell:
      return {"--mca", "plm", "rsh", "--mca", "btl", "self,vader,tcp",
              // A disconnected host is detected after three seconds of silence and three
              // probes; the default is minutes.
              "--mca", "oob_tcp_keepalive_time", "3", "--mca", "oob_tcp_keepalive_intvl", "1", "--mca",
              "oob_tcp_keepalive_probes", "3"};
    case Launch::slurm:
      return {"--mca", "btl", "self,vader,tcp"};
  }
  return {};
}

/// The same for Open MPI from 5 on, whose launcher is PRRTE and whose shared-memory transport is `sm`.
Words launch_by_prrte(const Placement& placement, const std::filesystem::path& folder) {
  switch (placement.launch) {
    case Launch::this_machine:
      return {"--mca",
              "btl",
              "self,sm",
              "--prtemca",
              "ras",
              "^slurm",
              "--prtemca",
              "prte_tmpdir_base",
              folder.string(),
              "--mca",
              "btl_sm_backing_directory",
              shared_memory_folder(folder).string()};
    case Launch::remote_shell:
      return {"--prtemca",
              "plm",
              "ssh",
              "--mca",
              "btl",
              "self,sm,tcp",
              "--prtemca",
              "prte_oob_tcp_keepalive_time",
              "3",
              "--prtemca",
              "prte_oob_tcp_keepalive_intvl",
              "1",
              "--prtemca",
              "prte_oob_tcp_keepalive_probes",
              "3"};
    case Launch::slurm:
      return {"--mca", "btl", "self,sm,tcp"};
  }
  return {};
}

Words words_of_open_mpi(int major, const Placement& placement, const std::filesystem::path& folder) {
  const bool prrte = major >= 5;
  const bool elsewhere = placement.launch != Launch::this_machine;
  Words words;
  // Oversubscribe: groups often have more ranks than cores. Map by slot: hosts are filled one after another in
  // the order of the file, so that rank 0 is on the first, which is this one.
  if (prrte)
    append(words, {"--map-by", elsewhere ? "slot:OVERSUBSCRIBE" : ":OVERSUBSCRIBE"});
  else
    append(words, {"--oversubscribe"});
  // Ranks that wait must yield their cores to others.
  append(words, {"--bind-to", "none", "--mca", "mpi_yield_when_idle", "1"});
  if (elsewhere && !prrte) append(words, {"--map-by", "slot"});
  if (elsewhere && !placement.hosts.empty()) append(words, {"--hostfile", own_hostfile(folder).string()});
  append(words, prrte ? launch_by_prrte(placement, folder) : launch_by_orte(placement, folder));
  return words;
}

/// Options for MPICH, whose launcher is Hydra.
Words words_of_mpich(const Placement& placement, const std::filesystem::path& folder) {
  Words words{"-bind-to", "none"};
  if (placement.launch == Launch::this_machine) append(words, {"-launcher", "fork", "-hosts", "localhost"});
  if (placement.launch == Launch::remote_shell) append(words, {"-launcher", "ssh"});
  if (placement.launch == Launch::slurm) append(words, {"-launcher", "slurm"});
  if (placement.launch != Launch::this_machine && !placement.hosts.empty())
    append(words, {"-f", own_hostfile(folder).string()});
  return words;
}

}  // namespace

std::filesystem::path own_hostfile(const std::filesystem::path& folder) {
  return folder / "hosts";
}

std::filesystem::path shared_memory_folder(const std::filesystem::path& folder) {
  return folder / "ranks";
}

Words mpirun_words(const MpiLauncher& launcher, const Placement& placement,
                   const std::filesystem::path& folder) {
  Words words{launcher.program.string(), "-n", std::to_string(placement.ranks)};
  append(words, launcher.version.family == MpiFamily::mpich
                    ? words_of_mpich(placement, folder)
                    : words_of_open_mpi(launcher.version.major, placement, folder));
  return words;
}

std::string own_hostfile_text(MpiFamily family, const std::vector<Host>& hosts) {
  if (family == MpiFamily::open_mpi) return hostfile_text(hosts);
  std::string text;
  for (const Host& host : hosts) text += fmt::format("{}:{}\n", host.name, host.slots);
  return text;
}

Environment mpirun_environment(Environment nodes, const Placement& placement,
                               const std::filesystem::path& folder) {
  // Like orte_tmpdir_base, but only for this machine: other hosts do not have this folder, and use their own.
  if (placement.launch == Launch::remote_shell) nodes["TMPDIR"] = folder.string();
  return nodes;
}

Words launch_agent(const Environment& environment, bool (*is_there)(const std::string&)) {
  const auto set = environment.find("OMPI_MCA_plm_rsh_agent");
  std::istringstream alternatives(set == environment.end() || set->second.empty() ? "ssh : rsh" : set->second);
  Words first;
  for (std::string alternative; std::getline(alternatives, alternative, ':');) {
    std::istringstream stream(alternative);
    Words words;
    for (std::string word; stream >> word;) words.push_back(word);
    if (words.empty()) continue;
    if (is_there(words.front())) return words;
    if (first.empty()) first = words;
  }
  return first;
}

}  // namespace understudy::launcher
