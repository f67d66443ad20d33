// SPDX-License-Identifier: Apache-2.0
// Environments of child processes: injection variables for the viewer, none for the nodes.
#include "apps/understudy/processes/environment.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "apps/understudy/gl_server/client_environment.h"

namespace understudy::launcher {
namespace {

const Installation here{"/opt/understudy/bin", "/opt/understudy/lib"};

TEST(Environment, EveryMethodHasItsVariable) {
  EXPECT_EQ(settings_of(InjectionMethod::audit, here).variable, "LD_AUDIT");
  EXPECT_EQ(settings_of(InjectionMethod::audit, here).value, "/opt/understudy/lib/libunderstudy-audit.so");
  EXPECT_EQ(settings_of(InjectionMethod::preload, here).variable, "LD_PRELOAD");
  EXPECT_EQ(settings_of(InjectionMethod::preload, here).value, "/opt/understudy/lib/libunderstudy.so");
  EXPECT_EQ(settings_of(InjectionMethod::folder, here).variable, "LD_LIBRARY_PATH");
  EXPECT_EQ(settings_of(InjectionMethod::folder, here).value, "/opt/understudy/lib/entry");
}

TEST(Environment, PutsALibraryInFrontOfWhatTheUserHas) {
  Environment environment{{"LD_PRELOAD", "libuser.so"}};
  put_in_front(environment, "LD_PRELOAD", "entry.so");
  put_in_front(environment, "LD_AUDIT", "audit.so");
  EXPECT_EQ(environment["LD_PRELOAD"], "entry.so:libuser.so");
  EXPECT_EQ(environment["LD_AUDIT"], "audit.so");
}

TEST(Environment, NodesSeeNoLibraryAndNoOptionOfTheViewer) {
  const Environment nodes =
      node_environment({{"LD_AUDIT", "x.so"},
                        {"LD_PRELOAD", "y.so"},
                        {"LD_LIBRARY_PATH", "/usr/local/lib:/opt/understudy/lib/entry:/a"},
                        {"UNDERSTUDY_VERIFY", "1"},
                        {"UNDERSTUDY_RUN_DIR", "/run"},
                        {"HOME", "/nowhere"}},
                       here);
  EXPECT_EQ(nodes.count("LD_AUDIT"), 0);
  EXPECT_EQ(nodes.count("LD_PRELOAD"), 0);
  EXPECT_EQ(nodes.count("UNDERSTUDY_VERIFY"), 0);
  EXPECT_EQ(nodes.count("UNDERSTUDY_RUN_DIR"), 0);
  EXPECT_EQ(nodes.at("LD_LIBRARY_PATH"), "/usr/local/lib:/a");
  EXPECT_EQ(nodes.at("HOME"), "/nowhere");
  EXPECT_EQ(nodes.count("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"), geteuid() == 0 ? 1 : 0);
}

TEST(Environment, ALibraryPathThatHeldOnlyTheEntryLibraryIsGone) {
  EXPECT_EQ(node_environment({{"LD_LIBRARY_PATH", "/opt/understudy/lib/entry"}}, here).count("LD_LIBRARY_PATH"),
            0);
}

TEST(Environment, AProcessOfTheGlServerHasWhatIsListedAndNothingElse) {
  const Environment client = client_environment({{"AWS_SECRET_ACCESS_KEY", "x"},
                                                 {"HOME", "/nowhere"},
                                                 {"LD_PRELOAD", "y.so"},
                                                 {"LIBGL_DRIVERS_PATH", "/opt/mesa"},
                                                 {"UNDERSTUDY_CONNECT", "/run/nodes.sock"},
                                                 {"UNDERSTUDY_WHATEVER", "1"}});
  EXPECT_EQ(client, (Environment{{"LIBGL_DRIVERS_PATH", "/opt/mesa"},
                                 {"MESA_SHADER_CACHE_DISABLE", "true"},
                                 {"UNDERSTUDY_CONNECT", "/run/nodes.sock"},
                                 {"__GL_SHADER_DISK_CACHE", "0"}}));
}

TEST(Environment, SaysWhereLibrariesOfOpenGlAre) {
  const Environment environment{
      {"LD_LIBRARY_PATH", "/mine/lib::lib:/yours"}, {"LIBGL_DRIVERS_PATH", "/drivers"}, {"PATH", "/mine/bin"}};
  EXPECT_EQ(folders_of_libraries(environment),
            (std::vector<std::filesystem::path>{"/mine/lib", "/yours", "/drivers"}));
}

}  // namespace
}  // namespace understudy::launcher
