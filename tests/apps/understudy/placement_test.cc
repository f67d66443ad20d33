// SPDX-License-Identifier: Apache-2.0
// Placement of ranks: hostfiles, Slurm's node lists and environment, and the resulting command line of the MPI
// launcher.
#include "apps/understudy/hosts/placement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <climits>
#include <fstream>
#include <sstream>

#include "apps/understudy/hosts/hostfile.h"
#include "apps/understudy/hosts/mpirun_command.h"
#include "apps/understudy/hosts/slurm_node_list.h"

namespace understudy::launcher {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::vector<Host> parsed(const std::string& text) {
  std::istringstream stream(text);
  return parse_hostfile(stream, "hosts.txt");
}

std::string complaint_about(const std::string& text) {
  try {
    parsed(text);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "(none)";
}

class File {
 public:
  explicit File(const std::string& text) {
    std::string name = "/tmp/understudy-hosts-XXXXXX";
    close(mkstemp(name.data()));
    path_ = name;
    std::ofstream(path_) << text;
  }
  ~File() { std::filesystem::remove(path_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

bool is_node2(const std::string& host) {
  return host == "node2";
}
bool is_anything(const std::string&) {
  return true;
}
bool is_nothing(const std::string&) {
  return false;
}

std::string complaint_of_placement(const PlacementWish& wish, bool (*is_here)(const std::string&)) {
  try {
    placement_of(wish, {}, is_here);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "(none)";
}

TEST(Hostfile, IsReadAsOpenMpiReadsIt) {
  const std::vector<Host> hosts = parsed(
      "# four hosts\n\n  node1\nnode2 slots=4 # fast\nme@node3 slots=2 max_slots=8\n10.0.0.7 "
      "max-slots=2 slots=1\r\nnode1 slots=2\n");
  ASSERT_EQ(hosts.size(), 4U);
  EXPECT_EQ(hostfile_text(hosts), "node1 slots=3\nnode2 slots=4\nme@node3 slots=2\n10.0.0.7 slots=1\n");
  EXPECT_EQ(slots_of(hosts), 10);
  EXPECT_EQ(names_of(hosts), "node1, node2, me@node3, 10.0.0.7");
}

TEST(Hostfile, WhatIsWrongIsSaidInOneLineWithWhatIsExpected) {
  const std::string binary(
      "\x7f"
      "ELF\x02\x01\x00\n",
      8);
  for (const std::string& text :
       {std::string(), std::string("\n# nothing\n"), std::string("node1 slots=-1"),
        std::string("node1 slots=0"), std::string("node1 slots=many"), std::string("node1 slots="),
        std::string("node1 slots=99999999999"), std::string("node1 slots 2"), std::string("node1 node2"),
        std::string("node1 colour=red"), std::string("-oProxyCommand=reboot"), std::string("me@-oProxyCommand"),
        std::string("me@ slots=1"), std::string("a;b"), std::string("$(reboot)"), std::string("+n1"), binary,
        std::string(5000, 'x')}) {
    const std::string said = complaint_about(text);
    EXPECT_THAT(said, AllOf(HasSubstr("hosts.txt"), HasSubstr("node1 slots=2"))) << text;
    EXPECT_EQ(said.find('\n'), std::string::npos) << text;
  }
  EXPECT_THAT(complaint_about("node1\nnode2 slots=-1\n"), AllOf(HasSubstr("line 2"), HasSubstr("node2")));
  std::string crowd;
  for (int i = 0; i < 300; ++i) crowd += "node" + std::to_string(i) + "\n";
  EXPECT_THAT(complaint_about(crowd), HasSubstr("at most 256 hosts"));
}

TEST(Hostfile, AFileThatCannotBeReadIsNamed) {
  for (const std::string path : {"/nowhere/hosts", "/tmp"}) {
    try {
      read_hostfile(path);
      ADD_FAILURE() << path;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), AllOf(HasSubstr(path), HasSubstr("cannot be read"), HasSubstr("expected")));
    }
  }
}

TEST(Hostfile, KnowsThisMachine) {
  std::array<char, HOST_NAME_MAX + 1> name{};
  ASSERT_EQ(gethostname(name.data(), name.size() - 1), 0);
  for (const std::string& host : {std::string(name.data()), std::string("localhost"), std::string("127.0.0.1"),
                                  "me@" + std::string(name.data())})
    EXPECT_TRUE(is_this_machine(host)) << host;
  // 192.0.2.0/24 is reserved for documentation.
  EXPECT_FALSE(is_this_machine("192.0.2.7"));
  EXPECT_FALSE(is_this_machine("no-such-host.invalid"));
}

TEST(SlurmNodes, AreWrittenOut) {
  EXPECT_THAT(slurm_nodes("gpu1"), ElementsAre("gpu1"));
  EXPECT_THAT(slurm_nodes("gpu1,node[01-03,7]"), ElementsAre("gpu1", "node01", "node02", "node03", "node7"));
  EXPECT_THAT(slurm_nodes("r[1-2]n[9-10]-ib"), ElementsAre("r1n9-ib", "r1n10-ib", "r2n9-ib", "r2n10-ib"));
  for (const char* senseless :
       {"", "n[1-2", "n[2-1]", "n[a-b]", "n[]", ",", "n[0-99999999]", "n[1-4000]m[1-4000]"})
    EXPECT_TRUE(slurm_nodes(senseless).empty()) << senseless;
}

TEST(Placement, WithoutAHostfileAllRanksAreHere) {
  const Placement placement = placement_of({3, {}}, {}, is_nothing);
  EXPECT_EQ(placement.launch, Launch::this_machine);
  EXPECT_EQ(placement.ranks, 3);
  EXPECT_EQ(placement_of({}, {}, is_nothing).ranks, 0);
  EXPECT_EQ(placement_of({0, {}}, {}, is_nothing).ranks, 0);
}

TEST(Placement, ThisMachineComesFirstAndSlotsAreRanks) {
  const File file("node1 slots=2\nnode2 slots=1\nnode3\n");
  const Placement placement = placement_of({{}, file.path()}, {}, is_node2);
  EXPECT_EQ(placement.launch, Launch::remote_shell);
  EXPECT_EQ(placement.ranks, 4);
  EXPECT_EQ(names_of(placement.hosts), "node2, node1, node3");
  EXPECT_EQ(placement_of({6, file.path()}, {}, is_node2).ranks, 6);
  const File alone("node2 slots=2\n");
  EXPECT_EQ(placement_of({{}, alone.path()}, {}, is_node2).launch, Launch::this_machine);
}

TEST(Placement, AHostfileWithoutThisMachineIsRefusedWithTheFix) {
  const File file("node1 slots=2\nnode3\n");
  EXPECT_THAT(complaint_of_placement({{}, file.path()}, is_node2),
              AllOf(HasSubstr("not this machine"), HasSubstr("node1, node3"), HasSubstr("localhost slots=1")));
  const File huge("node2 slots=200\nnode1 slots=200\n");
  EXPECT_THAT(complaint_of_placement({{}, huge.path()}, is_node2), HasSubstr("give -n N"));
  EXPECT_EQ(complaint_of_placement({7, huge.path()}, is_node2), "(none)");
}

TEST(Placement, OnTheHostsThatAreLeft) {
  const Placement four{Launch::remote_shell, 4, {{"a"}, {"b"}, {"c"}, {"d"}}};
  EXPECT_EQ(without_hosts(four, {}).ranks, 4);
  const Placement three = without_hosts(four, {"c"});
  EXPECT_EQ(three.ranks, 3);
  EXPECT_EQ(names_of(three.hosts), "a, b, d");
  EXPECT_EQ(three.launch, Launch::remote_shell);
  const Placement one = without_hosts(four, {"b", "c", "d"});
  EXPECT_EQ(one.ranks, 1);
  EXPECT_EQ(one.launch, Launch::this_machine);
  // If there are fewer ranks than slots, ranks move to free slots; if there are more, the ranks per slot stay
  // the same.
  EXPECT_EQ(without_hosts({Launch::remote_shell, 3, four.hosts}, {"b"}).ranks, 3);
  EXPECT_EQ(without_hosts({Launch::remote_shell, 8, four.hosts}, {"b"}).ranks, 6);
}

const Environment allocation{
    {"SLURM_JOB_ID", "17"}, {"SLURM_NTASKS", "6"}, {"SLURM_JOB_NODELIST", "node[1-3]"}};

TEST(Placement, ASlurmAllocationGivesRanksAndStartsThem) {
  const Placement placement = placement_of({}, allocation, is_node2);
  EXPECT_EQ(placement.launch, Launch::slurm);
  EXPECT_EQ(placement.ranks, 6);
  EXPECT_TRUE(placement.hosts.empty());
  EXPECT_EQ(placement_of({2, {}}, allocation, is_node2).ranks, 2);
  EXPECT_EQ(placement_of({0, {}}, allocation, is_node2).ranks, 0) << "-n 0 is a wish, too";
  const File file("node1\nnode2\n");
  const Placement listed = placement_of({{}, file.path()}, allocation, is_node2);
  EXPECT_EQ(listed.launch, Launch::slurm);
  EXPECT_EQ(listed.ranks, 2);
  EXPECT_EQ(names_of(listed.hosts), "node2, node1");
}

TEST(Placement, AnAllocationThatThisMachineIsNotInIsLeftAlone) {
  const Placement elsewhere = placement_of({}, allocation, is_nothing);
  EXPECT_EQ(elsewhere.launch, Launch::this_machine);
  EXPECT_EQ(elsewhere.ranks, 0);
  // An interactive shell (one task) does not request a node group; an allocation of one node needs no Slurm
  // launch.
  Environment shell = allocation;
  shell["SLURM_NTASKS"] = "1";
  EXPECT_EQ(placement_of({}, shell, is_anything).ranks, 0);
  Environment one_node = allocation;
  one_node["SLURM_JOB_NODELIST"] = "node2";
  EXPECT_EQ(placement_of({}, one_node, is_node2).launch, Launch::this_machine);
  EXPECT_EQ(placement_of({}, one_node, is_node2).ranks, 6);
}

std::string line_of(const Placement& placement, MpiFamily family = MpiFamily::open_mpi, int major = 4) {
  std::string line;
  for (const std::string& word : mpirun_words({"mpirun", {family, major, {}}}, placement, "/run/x"))
    line += (line.empty() ? "" : " ") + word;
  return line;
}

TEST(MpiVersion, IsReadOfWhatTheLauncherSays) {
  const auto text_of = [](const char* said) {
    return mpi_version(said).value_or(MpiVersion{.text = "none"}).text;
  };
  EXPECT_EQ(text_of("mpirun (Open MPI) 4.1.4\n\nReport bugs to http://www.open-mpi.org/community/help/\n"),
            "Open MPI 4.1.4");
  EXPECT_EQ(text_of("mpirun (Open MPI) 5.0.7rc2\n"), "Open MPI 5.0.7rc2");
  EXPECT_EQ(mpi_version("mpirun (Open MPI) 5.0.7\n")->major, 5);
  EXPECT_EQ(text_of("HYDRA build details:\n    Version:                                 4.0.2\n    CC:  gcc\n"),
            "MPICH 4.0.2");
  EXPECT_EQ(text_of("Intel(R) MPI Library for Linux* OS, Version 2021.9 Build 20230306\n"), "none");
  EXPECT_EQ(text_of("bash: mpirun: command not found\n"), "none");
  EXPECT_EQ(text_of("mpirun (Open MPI) \n"), "none");
  EXPECT_EQ(text_of(""), "none");
}

/// A folder, the only one on PATH, with programs that print what MPI launchers print.
class LaunchersOnPath : public testing::Test {
 protected:
  LaunchersOnPath() {
    if (const char* const path = std::getenv("PATH")) before_ = path;
    std::string name = "/tmp/understudy-launchers-XXXXXX";
    folder_ = mkdtemp(name.data());
    setenv("PATH", folder_.c_str(), 1);
  }
  ~LaunchersOnPath() override {
    setenv("PATH", before_.c_str(), 1);
    std::filesystem::remove_all(folder_);
  }
  void put(const char* name, const char* said) const {
    std::ofstream(folder_ / name) << "#!/bin/sh\necho '" << said << "'\n";
    std::filesystem::permissions(folder_ / name, std::filesystem::perms::owner_all);
  }
  static std::string found(MpiFamily family) {
    const auto found = find_mpi_launcher(family);
    if (const auto* const launcher = std::get_if<MpiLauncher>(&found))
      return launcher->program.filename().string() + ", " + launcher->version.text;
    return std::get<std::string>(found);
  }

 private:
  std::string before_;
  std::filesystem::path folder_;
};

TEST_F(LaunchersOnPath, AreTheMpiOfTheNodes) {
  EXPECT_THAT(found(MpiFamily::open_mpi),
              testing::AllOf(HasSubstr("mpirun is not on PATH"), HasSubstr("apt install openmpi-bin")));
  put("mpirun", "mpirun (Open MPI) 5.0.3");
  EXPECT_EQ(found(MpiFamily::open_mpi), "mpirun, Open MPI 5.0.3");
  EXPECT_THAT(found(MpiFamily::mpich), HasSubstr("mpirun is Open MPI 5.0.3; apt install mpich"));
  put("mpiexec.hydra", "HYDRA build details: Version: 4.1.2");
  EXPECT_EQ(found(MpiFamily::mpich), "mpiexec.hydra, MPICH 4.1.2");
  put("mpirun", "some other launcher");
  EXPECT_THAT(found(MpiFamily::open_mpi), HasSubstr("mpirun is of a different MPI"));
}

TEST(MpirunWords, OnThisMachineNeedNoNetwork) {
  EXPECT_EQ(
      line_of({Launch::this_machine, 4, {}}),
      "mpirun -n 4 --oversubscribe --bind-to none --mca mpi_yield_when_idle 1 --mca plm isolated --mca btl "
      "self,vader --mca ras ^slurm --mca orte_tmpdir_base /run/x "
      "--mca btl_vader_backing_directory /run/x/ranks");
}

TEST(MpirunWords, OnSeveralHostsNameThemAndUseTcp) {
  const Placement placement{Launch::remote_shell, 4, {{"a"}, {"b", 3}}};
  EXPECT_EQ(line_of(placement),
            "mpirun -n 4 --oversubscribe --bind-to none --mca mpi_yield_when_idle 1 --map-by slot --hostfile "
            "/run/x/hosts --mca plm rsh --mca btl self,vader,tcp --mca oob_tcp_keepalive_time 3 --mca "
            "oob_tcp_keepalive_intvl 1 --mca oob_tcp_keepalive_probes 3");
  EXPECT_EQ(mpirun_environment({}, placement, "/run/x")["TMPDIR"], "/run/x");
}

TEST(MpirunWords, InAnAllocationLeaveTheLaunchToSlurm) {
  const std::string line = line_of({Launch::slurm, 6, {}});
  EXPECT_THAT(line, AllOf(HasSubstr("-n 6"), HasSubstr("btl self,vader,tcp"), Not(HasSubstr("plm")),
                          Not(HasSubstr("ras")), Not(HasSubstr("--hostfile"))));
  EXPECT_THAT(line_of({Launch::slurm, 2, {{"a"}, {"b"}}}),
              AllOf(HasSubstr("--hostfile /run/x/hosts"), Not(HasSubstr("plm"))));
  EXPECT_EQ(mpirun_environment({}, {Launch::slurm, 6, {}}, "/run/x").count("TMPDIR"), 0U);
}

TEST(MpirunWords, OfOpenMpi5AreThoseOfPrrte) {
  const auto line = [](const Placement& placement) { return line_of(placement, MpiFamily::open_mpi, 5); };
  EXPECT_EQ(
      line({Launch::this_machine, 4, {}}),
      "mpirun -n 4 --map-by :OVERSUBSCRIBE --bind-to none --mca mpi_yield_when_idle 1 --mca btl self,sm "
      "--prtemca ras ^slurm --prtemca prte_tmpdir_base /run/x --mca btl_sm_backing_directory /run/x/ranks");
  EXPECT_THAT(line({Launch::remote_shell, 4, {{"a"}, {"b", 3}}}),
              testing::AllOf(HasSubstr("--map-by slot:OVERSUBSCRIBE"), HasSubstr("--hostfile /run/x/hosts"),
                             HasSubstr("--prtemca plm ssh"), HasSubstr("btl self,sm,tcp"),
                             Not(HasSubstr("vader")), Not(HasSubstr("orte"))));
  EXPECT_THAT(line({Launch::slurm, 6, {}}), Not(HasSubstr("--prtemca")));
}

TEST(MpirunWords, OfMpichAreThoseOfHydra) {
  const auto line = [](const Placement& placement) { return line_of(placement, MpiFamily::mpich); };
  EXPECT_EQ(line({Launch::this_machine, 4, {}}), "mpirun -n 4 -bind-to none -launcher fork -hosts localhost");
  EXPECT_EQ(line({Launch::remote_shell, 4, {{"a"}, {"b", 3}}}),
            "mpirun -n 4 -bind-to none -launcher ssh -f /run/x/hosts");
  EXPECT_EQ(line({Launch::slurm, 6, {}}), "mpirun -n 6 -bind-to none -launcher slurm");
  const std::vector<Host> hosts{{"a"}, {"b", 3}};
  EXPECT_EQ(own_hostfile_text(MpiFamily::mpich, hosts), "a:1\nb:3\n");
  EXPECT_EQ(own_hostfile_text(MpiFamily::open_mpi, hosts), "a slots=1\nb slots=3\n");
}

TEST(LaunchAgent, IsOpenMpisOwnChoice) {
  const auto only_rsh = [](const std::string& program) { return program == "rsh"; };
  const auto everything = [](const std::string&) { return true; };
  const auto nothing = [](const std::string&) { return false; };
  EXPECT_THAT(launch_agent({}, everything), ElementsAre("ssh"));
  EXPECT_THAT(launch_agent({}, only_rsh), ElementsAre("rsh"));
  EXPECT_THAT(launch_agent({}, nothing), ElementsAre("ssh"));
  const Environment own{{"OMPI_MCA_plm_rsh_agent", "/opt/agent -p 2222 : ssh"}};
  EXPECT_THAT(launch_agent(own, everything), ElementsAre("/opt/agent", "-p", "2222"));
}

}  // namespace
}  // namespace understudy::launcher
