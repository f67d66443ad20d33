// SPDX-License-Identifier: Apache-2.0
// The matrix of injection methods: which ways of opening OpenGL each injection method intercepts. Needs neither
// X nor a GPU: the driver behind the injection method (UNDERSTUDY_DRIVER_DIR) prints what it is asked for; the
// system's own OpenGL, reached without interception, prints nothing.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>
#include <string>
#include <tuple>
#include <vector>

#include "injection_methods.h"
#include "run_program.h"

namespace {

using namespace understudy::testing;

enum class Expected {
  hit,    ///< the call was intercepted
  miss,   ///< it went to the system's OpenGL, as if we were not there, and the application works
  crash,  ///< the one pattern that an injection method cannot serve: README.md of interceptor/ names it and
          ///< gives the reason
};

struct WayIn {
  const char* name;
  std::vector<std::string> command;
  const char* driver_says;
  Expected preload;
  Expected folder;
  Expected audit;

  Expected expected(InjectionMethod injection) const {
    switch (injection) {
      case InjectionMethod::none:
        return Expected::miss;
      case InjectionMethod::preload:
        return preload;
      case InjectionMethod::folder:
        return folder;
      case InjectionMethod::audit:
        return audit;
    }
    return Expected::miss;
  }
};

const std::string clients = CLIENTS "/";
const std::string library_folder = LIBRARY_FOLDER "/";
constexpr Expected hit = Expected::hit;
constexpr Expected miss = Expected::miss;
constexpr Expected crash = Expected::crash;
const char* const clear = "driver: glClear";
const char* const display = "driver: eglGetDisplay";
const char* const osmesa = "driver: OSMesa create";

std::vector<std::string> python(const std::string& library) {
  return {PYTHON, "-c", "import ctypes; ctypes.CDLL('" + library + "').glClear(0x4000); print('done')"};
}

// clang-format off
const std::vector<WayIn> ways_in = {
    // way in                      program                                                         answer   preload folder audit
    {"LinkedWithLibGL",            {clients + "linked_gl"},                                        clear,   hit,   hit,   hit},
    {"LinkedWithLibOpenGL",        {clients + "linked_opengl"},                                    clear,   hit,   hit,   hit},
    {"GetProcAddress",             {clients + "proc_address"},                                     clear,   hit,   hit,   hit},
    {"OpenedByName",               {clients + "opened", "libGL.so.1", "glClear"},                  clear,   hit,   hit,   hit},
    {"OpenedByAbsolutePath",       {clients + "opened", library_folder + "libGL.so.1", "glClear"}, clear,   hit,   miss,  hit},
    {"OpenedByFullFileName",       {clients + "opened", REAL_GL_FILE, "glClear"},                  clear,   hit,   miss,  hit},
    {"OpenedAsLibOpenGL",          {clients + "opened", "libOpenGL.so.0", "glClear"},              clear,   hit,   hit,   hit},
    {"PluginWithDeepbind",         {clients + "plugin_host", clients + "libdraws.so", "deep"},     clear,   hit,   hit,   hit},
    {"PluginOfTheCallersRunpath",  {clients + "runpath_host", "libdraws_by_runpath.so"},           clear,   hit,   hit,   hit},
    {"GlobalPointerNamedGlClear",  {clients + "pointer_host"},                                     clear,   crash, hit,   hit},
    {"PythonCtypes",               python("libGL.so.1"),                                           clear,   hit,   hit,   hit},
    {"PythonCtypesDevelopmentName", python("libGL.so"),                                            clear,   hit,   hit,   hit},
    {"DeepbindPluginOfALinkedProgram", {clients + "linked_plugin_host", clients + "libdraws.so", "deep"},
                                                                                                   clear,   hit,   hit,   hit},
    {"FunctionOfAPluginsDependency", {clients + "opened", clients + "libdraws.so", "glClear"},     clear,   hit,   hit,   hit},
    {"Plugin",                     {clients + "plugin_host", clients + "libdraws.so"},             clear,   hit,   hit,   hit},
    {"LinkedWithLibEGL",           {clients + "linked_egl"},                                       display, hit,   hit,   hit},
    {"OpenedLibEGL",               {clients + "opened", "libEGL.so.1", "eglGetDisplay"},           display, hit,   hit,   hit},
    {"OpenedLibEGLDevelopmentName", {clients + "opened", "libEGL.so", "eglGetDisplay"},            display, hit,   hit,   hit},
    {"OpenedLibEGLByAbsolutePath", {clients + "opened", library_folder + "libEGL.so.1", "eglGetDisplay"},
                                                                                                   display, hit,   miss,  hit},
    {"LinkedWithLibOSMesa",        {clients + "linked_osmesa"},                                    osmesa,  hit,   hit,   hit},
    {"OpenedLibOSMesa",            {clients + "opened", "libOSMesa.so.8", "OSMesaCreateContext"},  osmesa,  hit,   hit,   hit},
    {"OpenedLibOSMesaByItsOldName", {clients + "opened", "libOSMesa.so.6", "OSMesaCreateContext"}, osmesa,  hit,   miss,  hit},
    {"OpenedLibOSMesaByAbsolutePath", {clients + "opened", library_folder + "libOSMesa.so.8", "OSMesaCreateContext"},
                                                                                                   osmesa,  hit,   miss,  hit},
    {"OSMesaGetProcAddress",       {clients + "osmesa_address"},                                   osmesa,  hit,   hit,   hit},
};
// clang-format on

class InjectionMatrix : public ::testing::TestWithParam<std::tuple<WayIn, InjectionMethod>> {};

TEST_P(InjectionMatrix, AnswersAsTheTableSays) {
  const auto& [way, injection] = GetParam();
  if (way.command[0].empty()) GTEST_SKIP() << "no Python here";
  std::vector<std::string> environment = environment_of(injection);
  environment.push_back("UNDERSTUDY_DRIVER_DIR=" TEST_DRIVER);
  const Outcome outcome = run_program(environment, way.command);
  const std::string cell = std::string(way.name) + " through " + name_of(injection) + ": " + outcome.text;
  switch (way.expected(injection)) {
    case Expected::hit:
      EXPECT_TRUE(outcome.says(way.driver_says)) << cell;
      EXPECT_TRUE(outcome.says("done")) << cell;
      EXPECT_EQ(outcome.status, 0) << cell;
      break;
    case Expected::miss:
      EXPECT_FALSE(outcome.says(way.driver_says)) << cell;
      EXPECT_TRUE(outcome.says("done")) << cell;
      EXPECT_EQ(outcome.status, 0) << cell;
      break;
    case Expected::crash:
      EXPECT_EQ(outcome.status, 128 + SIGSEGV) << cell << " (if this works now, say so in the table)";
      break;
  }
}

std::string cell_name(const ::testing::TestParamInfo<InjectionMatrix::ParamType>& info) {
  return std::string(std::get<0>(info.param).name) + "_" + name_of(std::get<1>(info.param));
}

void PrintTo(const WayIn& way, std::ostream* out) {
  *out << way.name;
}

INSTANTIATE_TEST_SUITE_P(InjectionMethods, InjectionMatrix,
                         ::testing::Combine(::testing::ValuesIn(ways_in),
                                            ::testing::Values(InjectionMethod::none, InjectionMethod::preload,
                                                              InjectionMethod::folder, InjectionMethod::audit)),
                         cell_name);

class WithoutOpenGl : public ::testing::TestWithParam<InjectionMethod> {};

TEST_P(WithoutOpenGl, NeitherCoreNorDriverIsLoaded) {
  const Outcome outcome = run_program(environment_of(GetParam()), {clients + "no_gl"});
  EXPECT_EQ(outcome.status, 0);
  ASSERT_TRUE(outcome.says("libz.so") && outcome.says("done")) << outcome.text;
  for (const char* unwanted : {LIBRARY_FOLDER "/libGL", LIBRARY_FOLDER "/libOpenGL", LIBRARY_FOLDER "/libEGL",
                               "libGLdispatch", "libOSMesa", "libunderstudy-core"}) {
    EXPECT_FALSE(outcome.says(unwanted)) << unwanted << " in\n" << outcome.text;
  }
}

INSTANTIATE_TEST_SUITE_P(InjectionMethods, WithoutOpenGl,
                         ::testing::Values(InjectionMethod::preload, InjectionMethod::folder,
                                           InjectionMethod::audit),
                         [](const auto& info) { return name_of(info.param); });

}  // namespace
