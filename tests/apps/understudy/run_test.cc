// SPDX-License-Identifier: Apache-2.0
// `understudy run` as seen by its user: the viewer's own exit status, one summary line, nothing left behind.
// The viewers here are shell commands that do not use OpenGL.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <thread>

namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

struct Result {
  int status = 0;
  std::string output;  ///< stdout and stderr
};

Result shell(const std::string& command) {
  Result result;
  std::FILE* output = popen(("exec 2>&1; " + command).c_str(), "r");
  std::array<char, 4096> part{};
  for (std::size_t count = 0; (count = fread(part.data(), 1, part.size(), output)) > 0;) {
    result.output.append(part.data(), count);
  }
  const int status = pclose(output);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  return result;
}

/// `arguments` are parsed by the shell.
Result understudy(const std::string& arguments) {
  return shell(UNDERSTUDY_PROGRAM " " + arguments);
}

/// Returns "" if the file cannot be read, for example because its process has just ended.
std::string contents(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

class UnderstudyRun : public ::testing::Test {
 protected:
  UnderstudyRun() {
    fs::create_directories(folder_);
    // Every run creates its folder here, so that leftovers can be detected.
    setenv("XDG_RUNTIME_DIR", folder_.c_str(), 1);
  }
  ~UnderstudyRun() override { fs::remove_all(folder_); }

  bool nothing_is_left() const {
    for (const auto& entry : fs::directory_iterator(folder_)) {
      if (entry.path().filename().string().starts_with("understudy-")) return false;
    }
    return true;
  }

  /// Waits up to three minutes for another process. This is long enough to be called a failure: after one
  /// minute the launcher ends a group that does not start.
  template <typename Condition>
  static bool comes_true(Condition condition) {
    for (int tenths = 0; tenths < 1800; ++tenths) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  }

  fs::path folder_ = fs::temp_directory_path() / ("run-command-test-" + std::to_string(getpid()));
};

/// Number of UTF-8 characters.
std::ptrdiff_t width(const std::string& line) {
  return std::ranges::count_if(line, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
}

TEST_F(UnderstudyRun, HelpFitsIntoAHundredColumns) {
  for (const char* const subcommand : {"", "run", "serve", "replay", "print", "trim", "render", "view", "study",
                                       "compare", "ctl", "key", "doctor", "units", "completion"}) {
    const Result help = understudy(std::string(subcommand) + " --help");
    EXPECT_EQ(help.status, 0) << subcommand;
    std::istringstream lines(help.output);
    for (std::string line; std::getline(lines, line);)
      EXPECT_LE(width(line), 100) << subcommand << ": " << line;
  }
  EXPECT_THAT(understudy("render --help").output, HasSubstr("\nNodes:\n"));
}

TEST_F(UnderstudyRun, DoctorSaysWhetherTheSandboxOfGlServersHolds) {
  const bool has_seccomp = contents("/proc/self/status").find("\nSeccomp:\t") != std::string::npos;
  const std::string output = understudy("doctor").output;
  EXPECT_THAT(output, HasSubstr(has_seccomp ? "\nok       sandbox           seccomp" : "\nmissing  sandbox"));
  EXPECT_EQ(output.find("cannot open files, start programs or create sockets") != std::string::npos,
            has_seccomp);
}

TEST_F(UnderstudyRun, AViewerThatEndsWithoutADisplayIsToldOfIt) {
  const auto said_with = [&](const std::string& display, const std::string& viewer) {
    const std::optional<std::string> before =
        std::getenv("DISPLAY") != nullptr ? std::optional<std::string>(std::getenv("DISPLAY")) : std::nullopt;
    display.empty() ? unsetenv("DISPLAY") : setenv("DISPLAY", display.c_str(), 1);
    std::string said = understudy("run -- " + viewer).output;
    before ? setenv("DISPLAY", before->c_str(), 1) : unsetenv("DISPLAY");
    return said;
  };
  EXPECT_THAT(said_with("", "false"), HasSubstr("DISPLAY is not set: a viewer with windows needs an X server"));
  EXPECT_THAT(said_with("", "true"), ::testing::Not(HasSubstr("DISPLAY")));
  EXPECT_THAT(said_with(":1234", "false"), ::testing::Not(HasSubstr("DISPLAY")));
}

TEST_F(UnderstudyRun, DoctorRunsAViewerByEachWay) {
  const Result deep = understudy("doctor --deep --json");
  const auto findings = nlohmann::json::parse(deep.output);
  std::vector<std::string> works;
  for (const auto& one : findings)
    if (one["works"]) works.push_back(one["name"]);
  EXPECT_THAT(works, ::testing::IsSupersetOf({"run, audit", "run, preload", "run, folder", "run, two nodes"}))
      << deep.output;
  EXPECT_EQ(findings.size(), 13U);
}

TEST_F(UnderstudyRun, ABadHostfileIsRefusedInOneLineBeforeAnythingStarts) {
  const auto file = [&](const std::string& text) {
    std::ofstream(folder_ / "hosts") << text;
    return (folder_ / "hosts").string();
  };
  const auto refused = [&](const std::string& hostfile, const std::string& why) {
    const fs::path mark = folder_ / "started";
    for (const std::string& command :
         {"run --hostfile " + hostfile + " -- touch " + mark.string(),
          "serve --hostfile " + hostfile + " --socket " + (folder_ / "sock").string(),
          "render synthetic:8x8x8 --hostfile " + hostfile + " --out " + mark.string() + ".png"}) {
      const Result result = understudy(command);
      EXPECT_NE(result.status, 0) << command;
      EXPECT_THAT(result.output, HasSubstr(why)) << command;
      EXPECT_EQ(std::count(result.output.begin(), result.output.end(), '\n'), 1) << result.output;
    }
    EXPECT_FALSE(fs::exists(mark));
    EXPECT_TRUE(nothing_is_left());
  };
  refused("/nowhere/hosts", "cannot be read: No such file or directory; expected one host per line");
  refused(folder_.string(), "cannot be read: Is a directory");
  refused(file("# nobody\n"), "lists no host");
  refused(file("localhost slots=-2\n"), "the slots of 'localhost' must be a number from 1 to 256");
  refused(file("localhost\n\x01\x02\n"), "line 2: not the name or address of a host");
  refused(file("192.0.2.7 slots=2\n"), "not this machine");
}

TEST_F(UnderstudyRun, NodesAreWantedByNumberOrByHosts) {
  const Result result = understudy("serve --socket " + (folder_ / "sock").string());
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.output, HasSubstr("give -n N, or --hostfile FILE"));
}

TEST_F(UnderstudyRun, SaysNothingWhereItIsToBeQuiet) {
  EXPECT_EQ(understudy("run --quiet -- true").output, "");
}

TEST_F(UnderstudyRun, ReturnsTheViewersOwnExitStatusAndLeavesNothing) {
  for (const int status : {0, 7, 255}) {
    const Result result = understudy("run -- sh -c 'exit " + std::to_string(status) + "'");
    EXPECT_EQ(result.status, status) << result.output;
    EXPECT_THAT(result.output, HasSubstr("understudy: 0 volumes seen, 0 frames: 0 substituted"));
  }
  EXPECT_TRUE(nothing_is_left());
}

TEST_F(UnderstudyRun, ReturnsAKilledViewersStatusAsAShellWould) {
  EXPECT_EQ(understudy("run -- sh -c 'kill -9 $$'").status, 128 + SIGKILL);
  EXPECT_TRUE(nothing_is_left());
}

TEST_F(UnderstudyRun, SaysWhichViewerItCannotStart) {
  const Result missing = understudy("run -- no-such-viewer");
  EXPECT_EQ(missing.status, 127);
  EXPECT_THAT(missing.output, HasSubstr("cannot start no-such-viewer: No such file"));
  EXPECT_EQ(understudy("run -- /dev/null").status, 126);
  const Result none = understudy("run");
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.output, HasSubstr("put it after --"));
  EXPECT_TRUE(nothing_is_left());
}

TEST_F(UnderstudyRun, HandsEverythingBehindTheDashesToTheViewer) {
  const Result result = understudy("run --verify -- printf '%s|' --verify -n '[a,b]' -- 'two words'");
  EXPECT_THAT(result.output, HasSubstr("--verify|-n|[a,b]|--|two words|"));
}

TEST_F(UnderstudyRun, TellsTheViewersSideItsOptions) {
  const Result result =
      understudy("run --verify=5 --debug-tint --save-frames " + (folder_ / "frames").string() + " --report " +
                 (folder_ / "r.json").string() + " -- env");
  EXPECT_THAT(result.output, HasSubstr("UNDERSTUDY_VERIFY=5\n"));
  EXPECT_THAT(result.output, HasSubstr("UNDERSTUDY_DEBUG_TINT=1\n"));
  EXPECT_THAT(result.output, HasSubstr("UNDERSTUDY_SAVE_FRAMES=" + (folder_ / "frames").string() + "\n"));
  EXPECT_THAT(result.output, HasSubstr("UNDERSTUDY_RUN_DIR=" + (folder_ / "understudy-run-").string()));
  EXPECT_THAT(result.output, Not(HasSubstr("UNDERSTUDY_REPORT"))) << "the report is the launcher's to write";
  EXPECT_EQ(nlohmann::json::parse(contents(folder_ / "r.json"))["frames"], 0);
  EXPECT_TRUE(fs::is_directory(folder_ / "frames"));
}

TEST_F(UnderstudyRun, RefusesAValueThatAnOptionCannotTake) {
  for (const char* wrong : {"--verify=often", "-n -1", "-n 1000000", "--injection window", "--backend vulkan",
                            "--no-such-option"}) {
    EXPECT_EQ(understudy("run " + std::string(wrong) + " -- true").status, 2) << wrong;
  }
}

TEST_F(UnderstudyRun, SaysThatABackendIsForNodes) {
  const Result result = understudy("run --backend gl -- true");
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.output, HasSubstr("--backend gl has no effect without nodes of this run"));
}

TEST_F(UnderstudyRun, ReportsAChainItDoesNotUnderstandBeforeTheViewerStarts) {
  const Result wrong = understudy("run --chain 'track volme driver' -- echo started");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.output, HasSubstr("chain, character 7: no unit is named volme; did you mean volume?"));
  EXPECT_THAT(wrong.output, Not(HasSubstr("started")));
  const Result missing = understudy("run --chain @/none.json -- echo started");
  EXPECT_EQ(missing.status, 2);
  EXPECT_THAT(missing.output, HasSubstr("/none.json: cannot read this chain file"));
  EXPECT_EQ(shell("UNDERSTUDY_CHAIN=track " UNDERSTUDY_PROGRAM " run -- echo started").status, 2);
  EXPECT_TRUE(nothing_is_left());
}

TEST_F(UnderstudyRun, HandsOnAChainThatMeansTheSameInEveryFolder) {
  std::ofstream(folder_ / "chain.json")
      << R"({"chain": [{"unit": "perf", "file": "p.json"}, "track", "driver"]})";
  const std::string command =
      "cd " + folder_.string() + "; " UNDERSTUDY_PROGRAM " run --chain @chain.json -- env";
  EXPECT_THAT(shell(command).output,
              HasSubstr("UNDERSTUDY_CHAIN=perf(file=" + (folder_ / "p.json").string() + ") track driver\n"));
}

TEST_F(UnderstudyRun, ListsTheUnits) {
  const Result units = understudy("units");
  EXPECT_EQ(units.status, 0);
  EXPECT_THAT(units.output, HasSubstr("\nvolume   "));
  EXPECT_THAT(units.output, HasSubstr("needs track before it"));
  EXPECT_THAT(units.output, HasSubstr("frames=a number or a range: 3, 3-10 or 3- [1-]"));
}

TEST_F(UnderstudyRun, PassesSignalsOnToTheViewer) {
  const fs::path ready = folder_ / "ready";
  const pid_t launcher = fork();
  if (launcher == 0) {
    const std::string script = "trap 'echo ended >" + (folder_ / "trapped").string() +
                               "; exit 3' TERM; echo >" + ready.string() + "; while :; do sleep 0.1; done";
    execl(UNDERSTUDY_PROGRAM, "understudy", "run", "--", "sh", "-c", script.c_str(), nullptr);
    _exit(99);
  }
  ASSERT_TRUE(comes_true([&] { return fs::exists(ready); }));
  kill(launcher, SIGTERM);
  int status = 0;
  ASSERT_EQ(waitpid(launcher, &status, 0), launcher);
  EXPECT_EQ(WEXITSTATUS(status), 3);
  EXPECT_EQ(contents(folder_ / "trapped"), "ended\n");
  EXPECT_TRUE(nothing_is_left());
}

TEST_F(UnderstudyRun, EndedByASignalItReturns143AndLeavesNothing) {
  const fs::path ready = folder_ / "ready";
  const pid_t launcher = fork();
  if (launcher == 0) {
    const std::string script = "echo >" + ready.string() + "; exec sleep 600";
    execl(UNDERSTUDY_PROGRAM, "understudy", "run", "--", "sh", "-c", script.c_str(), nullptr);
    _exit(99);
  }
  ASSERT_TRUE(comes_true([&] { return fs::exists(ready); }));
  kill(launcher, SIGTERM);
  int status = 0;
  ASSERT_EQ(waitpid(launcher, &status, 0), launcher);
  EXPECT_EQ(WEXITSTATUS(status), 128 + SIGTERM);
  EXPECT_TRUE(nothing_is_left());
}

TEST_F(UnderstudyRun, RunsTheViewerByItselfWhereMpiIsMissing) {
  const Result without =
      shell("PATH=/nowhere " UNDERSTUDY_PROGRAM " run -n 4 -- /bin/sh -c 'echo shown; exit 5'");
  EXPECT_EQ(without.status, 5);
  EXPECT_THAT(without.output, HasSubstr("apt install openmpi-bin"));
  EXPECT_THAT(without.output, HasSubstr("shown"));
  EXPECT_TRUE(nothing_is_left());
}

/// Process ids of the run's ranks, identified by the run's private folder, which holds their socket.
std::set<pid_t> ranks_of(const std::string& folder) {
  std::set<pid_t> ranks;
  for (const auto& process : fs::directory_iterator("/proc")) {
    const std::string command = contents(process.path() / "cmdline");
    if (contents(process.path() / "comm") == "understudy-node\n" && command.find(folder) != std::string::npos) {
      ranks.insert(std::stoi(process.path().filename()));
    }
  }
  return ranks;
}

/// A run on nodes whose viewer only waits until it is told to end.
class RunOnNodes {
 public:
  RunOnNodes(const fs::path& folder, int nodes)
      : socket_(folder / "socket"), done_(folder / "done"), said_(folder / "said") {
    const std::string script = "echo $UNDERSTUDY_CONNECT >" + socket_.string() + ".part; mv " +
                               socket_.string() + ".part " + socket_.string() + "; while [ ! -e " +
                               done_.string() + " ]; do sleep 0.1; done";
    launcher_ = fork();
    if (launcher_ != 0) return;
    if (freopen(said_.c_str(), "w", stderr) == nullptr) _exit(98);
    execl(UNDERSTUDY_PROGRAM, "understudy", "run", "-n", std::to_string(nodes).c_str(), "--", "sh", "-c",
          script.c_str(), nullptr);
    _exit(99);
  }

  bool viewer_runs() const { return fs::exists(socket_); }
  std::set<pid_t> ranks() const { return ranks_of(fs::path(contents(socket_)).parent_path()); }

  RunOnNodes(const RunOnNodes&) = delete;
  RunOnNodes& operator=(const RunOnNodes&) = delete;
  ~RunOnNodes() {
    if (launcher_ > 0) end();
  }

  /// Ends the viewer. Returns the launcher's exit status, or -1 if the launcher had to be killed after a
  /// minute.
  int end() {
    std::ofstream(done_) << "";
    int status = 0;
    for (int tenths = 0; tenths < 600; ++tenths) {
      if (waitpid(launcher_, &status, WNOHANG) == launcher_) {
        launcher_ = -1;
        return WEXITSTATUS(status);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    kill(launcher_, SIGKILL);
    waitpid(launcher_, &status, 0);
    launcher_ = -1;
    return -1;
  }
  std::string said() const { return contents(said_); }
  /// Its output and a list of all processes, for failure messages.
  std::string state() const {
    return said() + shell("ps -eo pid,ppid,stat,wchan:20,etime,args --forest").output;
  }

 private:
  fs::path socket_, done_, said_;
  pid_t launcher_ = -1;
};

bool nodes_are_built() {
  return fs::exists(fs::path(UNDERSTUDY_PROGRAM).replace_filename("understudy-node"));
}

TEST_F(UnderstudyRun, StartsAnotherNodeGroupWhenARankIsKilledAndSaysSoInOneLine) {
  if (!nodes_are_built()) GTEST_SKIP() << "built without MPI";
  RunOnNodes run(folder_, 3);
  ASSERT_TRUE(comes_true([&] { return run.viewer_runs(); }));
  std::set<pid_t> first;
  ASSERT_TRUE(comes_true([&] { return (first = run.ranks()).size() == 3; }));
  kill(*first.begin(), SIGKILL);
  EXPECT_TRUE(comes_true([&] {
    const std::set<pid_t> now = run.ranks();
    return now.size() == 3 &&
           std::none_of(now.begin(), now.end(), [&](pid_t rank) { return first.contains(rank); });
  }));
  EXPECT_EQ(run.end(), 0);
  const std::string text = run.said();
  EXPECT_THAT(text, HasSubstr("starting 3 again (attempt 1 of 5), meanwhile the viewer draws by itself\n"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2) << "one line on the loss, one at the end:\n" << text;
  EXPECT_TRUE(comes_true([&] { return run.ranks().empty(); }));
  EXPECT_TRUE(nothing_is_left());
}

/// mpirun 4.1.4 hangs occasionally when a rank dies while the ranks are still connecting.
TEST_F(UnderstudyRun, StartsAnotherNodeGroupWhenMpirunHangs) {
  if (!nodes_are_built()) GTEST_SKIP() << "built without MPI";
  const fs::path hung = folder_ / "hung";
  const fs::path mpirun = folder_ / "mpirun";
  const char* const set = getenv("PATH");
  const std::string path = set != nullptr ? set : "/usr/bin:/bin";
  std::ofstream(mpirun) << "#!/bin/sh\nPATH='" << path << "'\n[ \"$1\" = --version ] || [ -e " << hung.string()
                        << " ] || { : >" << hung.string() << "; exec sleep 1000; }\nexec mpirun \"$@\"\n";
  fs::permissions(mpirun, fs::perms::owner_all);
  setenv("PATH", (folder_.string() + ":" + path).c_str(), 1);
  RunOnNodes run(folder_, 2);
  setenv("PATH", path.c_str(), 1);
  EXPECT_TRUE(comes_true([&] { return run.viewer_runs() && run.ranks().size() == 2; })) << run.state();
  EXPECT_EQ(run.end(), 0);
  EXPECT_THAT(run.said(),
              HasSubstr("the render nodes are gone (they did not start within 60 s); starting 2 again "
                        "(attempt 1 of 5), meanwhile the viewer draws by itself\n"));
  EXPECT_TRUE(nothing_is_left());
}

TEST_F(UnderstudyRun, AReportThatCannotBeWrittenIsToldBeforeTheViewerStarts) {
  const fs::path mark = folder_ / "started";
  const Result result =
      understudy("run --report " + (folder_ / "missing" / "r.json").string() + " -- touch " + mark.string());
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.output, HasSubstr("cannot be written: No such file or directory"));
  EXPECT_FALSE(fs::exists(mark));
}

TEST_F(UnderstudyRun, PipesAreWrittenToAndNotReplaced) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  // Also opened for writing, so that nothing waits for the other end.
  const int end = ::open(pipe.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  const Result reported = understudy("run --report " + pipe.string() + " -- true");
  EXPECT_EQ(reported.status, 0) << reported.output;
  EXPECT_TRUE(fs::is_fifo(pipe));
  std::array<char, 1> first{};
  EXPECT_EQ(::read(end, first.data(), first.size()), 1);
  EXPECT_EQ(first[0], '{');
  const Result traced = understudy("run --trace " + pipe.string() + " -- true");
  EXPECT_NE(traced.status, 0);
  EXPECT_THAT(traced.output, HasSubstr("a trace can only be written to a file"));
  EXPECT_TRUE(fs::is_fifo(pipe));
  ::close(end);
}

TEST_F(UnderstudyRun, WhatTheEnvironmentAsksToWriteIsTriedBeforeTheViewerStarts) {
  const fs::path mark = folder_ / "started";
  std::ofstream(folder_ / "file") << "";
  for (const auto& [variable, path] : {std::pair{"UNDERSTUDY_REPORT", folder_ / "missing" / "r.json"},
                                       std::pair{"UNDERSTUDY_SAVE_FRAMES", folder_ / "file" / "frames"}}) {
    setenv(variable, path.c_str(), 1);
    const Result result = understudy("run -- touch " + mark.string());
    unsetenv(variable);
    EXPECT_EQ(result.status, 2) << variable;
    EXPECT_THAT(result.output, HasSubstr(path.string() + " cannot be ")) << variable;
    EXPECT_FALSE(fs::exists(mark)) << variable;
  }
}

TEST_F(UnderstudyRun, TheConfigurationFileComesBehindTheEnvironmentAndTheCommandLine) {
  const fs::path file = folder_ / "understudy.toml";
  std::ofstream(file) << "error = \"3/255\"\n[sh]\nsave-frames = \"" << (folder_ / "frames").string() << "\"\n";
  setenv("UNDERSTUDY_CONFIG", file.c_str(), 1);
  const std::string viewer = " -- sh -c 'echo error $UNDERSTUDY_ERROR frames $UNDERSTUDY_SAVE_FRAMES'";
  EXPECT_THAT(understudy("run" + viewer).output,
              HasSubstr("error 3/255 frames " + (folder_ / "frames").string() + "\n"));
  EXPECT_THAT(understudy("run --error 5/255" + viewer).output, HasSubstr("error 5/255 frames /"));
  setenv("UNDERSTUDY_ERROR", "4/255", 1);
  EXPECT_THAT(understudy("run" + viewer).output, HasSubstr("error 4/255 frames /"));
  EXPECT_THAT(understudy("config sh").output,
              ::testing::AllOf(HasSubstr("UNDERSTUDY_ERROR"), HasSubstr("line 3, [sh]")));
  unsetenv("UNDERSTUDY_ERROR");
  std::ofstream(file) << "eror = 1\n";
  const Result wrong = understudy("run -- true");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.output,
              HasSubstr("understudy.toml, line 1: `understudy run` has no option --eror; did you mean "));
  for (const char* refused : {"error = \"much\"\n", "explain = 3\n"}) {
    std::ofstream(file) << refused;
    EXPECT_EQ(understudy("run -- true").status, 2) << refused;
  }
  std::ofstream(file) << "nodes = 2\nspeed-guard = false\nexplain = false\n";
  const std::string figures = " -- sh -c 'echo guard $UNDERSTUDY_SPEED_GUARD explain $UNDERSTUDY_EXPLAIN.'";
  EXPECT_THAT(understudy("run -n 0" + figures).output, HasSubstr("guard off explain .\n"));
  setenv("UNDERSTUDY_NODES", "0", 1);
  EXPECT_THAT(understudy("config").output,
              ::testing::AllOf(HasSubstr("UNDERSTUDY_NODES"), Not(HasSubstr("line 1"))));
  unsetenv("UNDERSTUDY_NODES");
  unsetenv("UNDERSTUDY_CONFIG");
}

TEST(UnderstudyCompare, PrintsItsThreeLinesAndTellsWhatItCannotRead) {
  const fs::path folder =
      fs::temp_directory_path() / ("understudy-compare-command-" + std::to_string(getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / "a.pfm", std::ios::binary) << "Pf\n1 1\n-1.0\n" << std::string(4, '\0');
  const std::string a = (folder / "a.pfm").string();
  const Result same = understudy("compare " + a + " " + a);
  EXPECT_EQ(same.output, "max 0.0000\nRMS 0.0000\nPSNR inf dB\n");
  EXPECT_EQ(same.status, 0);
  const Result missing = understudy("compare " + a + " " + a + ".missing");
  EXPECT_NE(missing.status, 0);
  EXPECT_THAT(missing.output, HasSubstr("a.pfm.missing: No such file"));
  fs::remove_all(folder);
}

}  // namespace
