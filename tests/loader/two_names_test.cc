// SPDX-License-Identifier: Apache-2.0
// Programs that use several names of OpenGL. glibc first compares a requested name with the SONAMEs of the
// loaded libraries, so the order decides whether a later name still leads to ours. Every order is tested, with
// the system's own driver, because the real libraries have those SONAMEs.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "injection_methods.h"
#include "run_program.h"

namespace {

using namespace understudy::testing;

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += " " + word;
  return text;
}

class SeveralNames : public ::testing::TestWithParam<InjectionMethod> {
 protected:
  /// Checks that every name that the program opens leads to our library.
  static void expect_ours(const std::string& program, const std::vector<std::string>& names) {
    std::vector<std::string> command{CLIENTS "/" + program};
    command.insert(command.end(), names.begin(), names.end());
    const Outcome outcome = run_program(environment_of(GetParam()), command);
    const std::string which =
        std::string(name_of(GetParam())) + ": " + program + joined(names) + "\n" + outcome.text;
    EXPECT_EQ(outcome.status, 0) << which;
    EXPECT_TRUE(outcome.says("done")) << which;
    std::size_t ours = 0;
    for (const std::string& line : outcome.lines()) ours += line.ends_with("/libunderstudy.so") ? 1 : 0;
    EXPECT_EQ(ours, names.size()) << which;
  }
};

const std::vector<std::string> all_names{"libEGL.so.1", "libGL.so.1", "libGLX.so.0", "libOpenGL.so.0"};

TEST_P(SeveralNames, OpenedInEveryOrder) {
  std::vector<std::string> names = all_names;
  int orders = 0;
  do {
    expect_ours("names", names);
    ++orders;
  } while (std::next_permutation(names.begin(), names.end()));
  EXPECT_EQ(orders, 24);
}

TEST_P(SeveralNames, LinkedWithOneAndOpeningTheOthersInEveryOrder) {
  for (const char* linked :
       {"names_linked_GL", "names_linked_OpenGL", "names_linked_GLX", "names_linked_EGL"}) {
    std::vector<std::string> names = all_names;
    do {
      expect_ours(linked, names);
    } while (std::next_permutation(names.begin(), names.end()));
  }
}

TEST_P(SeveralNames, DevelopmentNamesLeadToTheSame) {
  expect_ours("names", {"libGL.so", "libGL.so.1", "libEGL.so", "libEGL.so.1", "libGLX.so", "libOpenGL.so"});
}

INSTANTIATE_TEST_SUITE_P(InjectionMethods, SeveralNames,
                         ::testing::Values(InjectionMethod::preload, InjectionMethod::folder,
                                           InjectionMethod::audit),
                         [](const auto& info) { return name_of(info.param); });

/// The injection methods that see paths; a folder of names does not.
class AbsolutePaths : public SeveralNames {};

TEST_P(AbsolutePaths, LeadToUsEvenWhenTheDriverIsLoadedFromThere) {
  for (const std::string folder : {LIBRARY_FOLDER, SYSTEM_FOLDER}) {
    const std::vector<std::string> paths{"libGL.so.1", folder + "/libGL.so.1", folder + "/libGLX.so.0",
                                         folder + "/libOpenGL.so.0", folder + "/libEGL.so.1"};
    expect_ours("names", paths);
    expect_ours("names_linked_GL", paths);
  }
}

INSTANTIATE_TEST_SUITE_P(InjectionMethods, AbsolutePaths,
                         ::testing::Values(InjectionMethod::preload, InjectionMethod::audit),
                         [](const auto& info) { return name_of(info.param); });

// The real libGL.so.1 then finds our libGLX.so.0 as its dependency (interceptor/glvnd.cc).
TEST(PastTheFolderMethod, ARealLibGlWorks) {
  const Outcome outcome =
      run_program(environment_of(InjectionMethod::folder), {CLIENTS "/names", REAL_GL_FILE, "libGLX.so.0"});
  EXPECT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_TRUE(outcome.says(REAL_GL_FILE " from " REAL_GL_FILE)) << outcome.text;
  EXPECT_TRUE(outcome.says("done")) << outcome.text;
}

}  // namespace
