// SPDX-License-Identifier: Apache-2.0
// The order of notifications to the core library and of calls to the driver: the entry library's side of
// core.h.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "run_program.h"

namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using understudy::testing::Outcome;
using understudy::testing::run_program;

Outcome play(const std::string& client, const std::string& scene, std::vector<std::string> environment = {},
             const std::string& stage = TEST_STAGE) {
  environment.push_back("LD_LIBRARY_PATH=" + stage + "/entry");
  environment.push_back("UNDERSTUDY_DRIVER_DIR=" TEST_DRIVER);
  return run_program(environment, {TEST_CLIENTS "/" + client, scene});
}

TEST(LifeCycle, AFrameFromTheFirstContextToItsEnd) {
  const Outcome outcome = play("glx_client", "one_frame");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.lines(),
              ElementsAre("driver: glClear",  // no context yet: straight to the driver
                          "driver: create 1 share 0", "driver: current 1 drawable 10", "core: open",
                          "core: current 1 share 0 glx desktop drawable 10",  //
                          "core: glClear", "driver: glClear",                 //
                          "core: glFlush", "driver: glFlush",                 //
                          "core: before swap", "driver: swap 10",
                          "driver: glFlush",         // the driver's own call: not intercepted
                          "core: after swap of 10",  //
                          "core: before make_current", "core: leaving after 2 calls",
                          "driver: current 0 drawable 0",  //
                          "driver: glClear",               //
                          "driver: destroy 1", "core: destroyed 1"));
}

TEST(LifeCycle, AFailedMakeCurrentLeavesTheOldContextToTheCore) {
  EXPECT_THAT(play("glx_client", "failed_make_current").lines(),
              ElementsAre("driver: create 1 share 0", "driver: current 1 drawable 10", "core: open",
                          "core: current 1 share 0 glx desktop drawable 10",           //
                          "core: before make_current", "core: leaving after 0 calls",  //
                          "driver: current 1 drawable 13 refused",                     //
                          "core: current 1 share 0 glx desktop drawable 10",           //
                          "core: glClear", "driver: glClear"));
}

TEST(LifeCycle, TheSameContextAndDrawableAgainIsNoChange) {
  EXPECT_THAT(play("glx_client", "same_again").lines(),
              ElementsAre("driver: create 1 share 0", "driver: current 1 drawable 10", "core: open",
                          "core: current 1 share 0 glx desktop drawable 10",             //
                          "core: before make_current", "driver: current 1 drawable 10",  //
                          "core: glClear", "driver: glClear",                            //
                          "core: before make_current", "core: leaving after 1 calls",
                          "driver: current 1 drawable 11",  // another window is another frame
                          "core: current 1 share 0 glx desktop drawable 11"));
}

TEST(LifeCycle, AShareGroupOutlivesItsFirstContext) {
  EXPECT_THAT(play("glx_client", "share_group").lines(),
              ElementsAre("driver: create 1 share 0", "driver: current 1 drawable 10", "core: open",
                          "core: current 1 share 0 glx desktop drawable 10",  //
                          "driver: create 2 share 1",                         //
                          "core: before make_current", "core: leaving after 0 calls",
                          "driver: current 0 drawable 0",  //
                          "driver: destroy 1",             // its objects survive in the second context
                          "app: the first is destroyed",   //
                          "driver: current 2 drawable 10", "core: current 2 share 1 glx desktop drawable 10",
                          "core: destroyed 1",  //
                          "core: before make_current", "core: leaving after 0 calls",
                          "driver: current 0 drawable 0",  //
                          "driver: destroy 2", "core: destroyed 2"));
}

TEST(LifeCycle, AHandleThatComesAgainIsAnotherContext) {
  EXPECT_THAT(play("glx_client", "handle_comes_again").lines(),
              ElementsAre("driver: create 1 share 0", "driver: current 1 drawable 10", "core: open",
                          "core: current 1 share 0 glx desktop drawable 10",           //
                          "core: before make_current", "core: leaving after 0 calls",  //
                          "driver: current 0 drawable 0", "driver: destroy 1", "core: destroyed 1",
                          "driver: create 1 share 0", "driver: current 1 drawable 10",  //
                          "core: current 2 share 0 glx desktop drawable 10",            //
                          "core: before make_current", "core: leaving after 0 calls",   //
                          "driver: current 0 drawable 0", "driver: destroy 1", "core: destroyed 2"));
}

TEST(LifeCycle, AContextDestroyedWhileCurrentLivesUntilItIsReleased) {
  EXPECT_THAT(play("glx_client", "destroyed_while_current").lines(),
              ElementsAre("driver: create 1 share 0", "driver: current 1 drawable 10", "core: open",
                          "core: current 1 share 0 glx desktop drawable 10",  //
                          "core: before destroy", "driver: destroy 1",        //
                          "core: glClear", "driver: glClear", "app: releasing", "core: before make_current",
                          "core: leaving after 1 calls", "driver: current 0 drawable 0", "core: destroyed 1"));
}

TEST(LifeCycle, EveryThreadHasItsOwnContextAndCount) {
  EXPECT_THAT(
      play("glx_client", "two_threads").lines(),
      ElementsAre("driver: create 1 share 0", "driver: create 2 share 1",  //
                  "driver: current 1 drawable 10", "core: open",
                  "core: current 1 share 0 glx desktop drawable 10", "core: glClear", "driver: glClear",
                  "driver: current 2 drawable 11", "core: current 2 share 1 glx desktop drawable 11",
                  "core: glClear", "driver: glClear",  //
                  "core: before make_current", "core: leaving after 1 calls",
                  "driver: current 0 drawable 0",      //
                  "core: glClear", "driver: glClear",  //
                  "core: before make_current", "core: leaving after 2 calls", "driver: current 0 drawable 0"));
}

TEST(LifeCycle, AContextWhoseThreadHasEndedGoesWhenItIsDestroyed) {
  EXPECT_THAT(play("glx_client", "thread_ends").lines(),
              ElementsAre("driver: create 1 share 0", "driver: current 1 drawable 11", "core: open",
                          "core: current 1 share 0 glx desktop drawable 11", "core: glClear",
                          "driver: glClear",  //
                          "app: the thread has ended", "driver: destroy 1", "core: destroyed 1"));
}

TEST(LifeCycle, GetProcAddressGivesOursWhereTheDriverHasOneAndNothingWhereItHasNone) {
  EXPECT_THAT(play("glx_client", "addresses").lines(),
              ElementsAre("app: glClear ours", "app: glXSwapBuffers ours", "app: glAccum null",
                          "app: glNoSuchFunction null", "driver: glVendorFunction"));
}

TEST(LifeCycle, AFunctionThatTheDriverLacksIsSaidOnceAndDoesNothing) {
  const Outcome outcome = play("glx_client", "missing_function");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.lines(),
              ElementsAre("understudy: the application calls glAccum, which this OpenGL driver lacks; "
                          "such calls do nothing",
                          "app: goes on"));
}

TEST(LifeCycle, AForkedChildGoesStraightToTheDriver) {
  const Outcome outcome = play("glx_client", "forked");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(
      outcome.lines(),
      ElementsAre("driver: create 1 share 0", "driver: current 1 drawable 10", "core: open",
                  "core: current 1 share 0 glx desktop drawable 10", "core: glClear", "driver: glClear",
                  "app: child", "driver: glClear", "driver: swap 10", "driver: glFlush",
                  "driver: current 1 drawable 11", "driver: create 2 share 0", "driver: current 2 drawable 10",
                  "driver: glClear",  //
                  "app: parent, child's status 0", "core: glClear", "driver: glClear",
                  "core: before make_current", "core: leaving after 2 calls", "driver: current 0 drawable 0"));
}

const std::vector<std::string> frame_without_core{"driver: glClear",
                                                  "driver: create 1 share 0",
                                                  "driver: current 1 drawable 10",
                                                  "driver: glClear",
                                                  "driver: glFlush",
                                                  "driver: swap 10",
                                                  "driver: glFlush",
                                                  "driver: current 0 drawable 0",
                                                  "driver: glClear",
                                                  "driver: destroy 1"};

TEST(LifeCycle, SwitchedOffTheCoreIsNeverOpenedAndNothingIsSaid) {
  EXPECT_THAT(play("glx_client", "one_frame", {"UNDERSTUDY_DISABLE=1"}).lines(),
              ElementsAreArray(frame_without_core));
}

// As for every switch (spu/options.cc).
TEST(LifeCycle, TheVariableSwitchesOffOnlyWhereItsValueSaysSo) {
  for (const std::string yes : {"1", "on", "yes", "true"}) {
    EXPECT_THAT(play("glx_client", "one_frame", {"UNDERSTUDY_DISABLE=" + yes}).lines(),
                ElementsAreArray(frame_without_core))
        << yes;
  }
  for (const std::string no : {"", "0", "off", "no", "false"}) {
    EXPECT_TRUE(play("glx_client", "one_frame", {"UNDERSTUDY_DISABLE=" + no}).says("core: open")) << no;
  }
}

TEST(LifeCycle, AMissingCoreIsSaidOnceAndTheApplicationDraws) {
  const Outcome outcome = play("glx_client", "one_frame", {}, TEST_STAGE "/bodiless");
  EXPECT_EQ(outcome.status, 0);
  std::vector<std::string> lines = outcome.lines();
  const auto said = std::stable_partition(lines.begin(), lines.end(),
                                          [](const std::string& line) { return line.starts_with("driver:"); });
  ASSERT_EQ(lines.end() - said, 1) << outcome.text;
  EXPECT_THAT(*said, ::testing::HasSubstr("libunderstudy-core.so"));
  EXPECT_THAT(*said, ::testing::HasSubstr("the application draws by itself"));
  EXPECT_TRUE(std::equal(lines.begin(), said, frame_without_core.begin(), frame_without_core.end()))
      << outcome.text;
}

TEST(LifeCycle, ACoreThatRefusesIsSaidOnceAndTheApplicationDraws) {
  const Outcome outcome = play("glx_client", "one_frame", {"TEST_CORE_REFUSES=1"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_TRUE(outcome.says("declined")) << outcome.text;
  EXPECT_FALSE(outcome.says("core: glClear")) << outcome.text;
  EXPECT_TRUE(outcome.says("driver: swap 10")) << outcome.text;
}

TEST(LifeCycle, AFolderWithoutADriverIsSaidAndTheSystemsIsTaken) {
  const Outcome outcome =
      run_program({"LD_LIBRARY_PATH=" TEST_STAGE "/entry", "UNDERSTUDY_DRIVER_DIR=/nonexistent"},
                  {TEST_CLIENTS "/glx_client", "addresses"});
  EXPECT_TRUE(outcome.says("UNDERSTUDY_DRIVER_DIR=/nonexistent holds no libGLX.so.0 or libGL.so.1"))
      << outcome.text;
  EXPECT_TRUE(outcome.says("app: glClear ours")) << outcome.text;
}

// VirtualGL ends the application if the supposed real library is VirtualGL itself; Understudy searches further.
TEST(LifeCycle, OurselvesAreNoDriver) {
  const Outcome outcome =
      run_program({"LD_LIBRARY_PATH=" TEST_STAGE "/entry", "UNDERSTUDY_DRIVER_DIR=" TEST_STAGE "/entry"},
                  {TEST_CLIENTS "/glx_client", "addresses"});
  EXPECT_TRUE(outcome.says("not Understudy's own")) << outcome.text;
  EXPECT_TRUE(outcome.says("app: glClear ours")) << outcome.text;
}

TEST(LifeCycle, EglsFrame) {
  const Outcome outcome = play("egl_client", "one_frame");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(
      outcome.lines(),
      ElementsAre("driver: eglGetDisplay", "driver: create 1 share 0", "driver: current 1 drawable 20",
                  "core: open", "core: current 1 share 0 egl desktop drawable 20", "core: glClear",
                  "driver: glClear", "core: before swap", "driver: swap 20", "core: after swap",  //
                  "core: before swap", "driver: swap 20 with damage", "core: after swap",         //
                  "core: before make_current", "core: leaving after 1 calls",
                  "driver: current 1 drawable 13 refused", "core: current 1 share 0 egl desktop drawable 20",
                  "core: glClear", "driver: glClear",  //
                  "core: before make_current", "core: leaving after 1 calls", "driver: release thread",
                  "driver: destroy 1", "core: destroyed 1"));
}

/// The lines of an EGL program whose calls, with a context, all end a frame in the same way.
std::vector<std::string> egl_with_frame_ends(const std::string& end, const std::vector<std::string>& calls) {
  std::vector<std::string> lines{"driver: eglGetDisplay", "driver: create 1 share 0",
                                 "driver: current 1 drawable 20", "core: open",
                                 "core: current 1 share 0 egl desktop drawable 20"};
  for (const std::string& call : calls)
    lines.insert(lines.end(), {"core: before " + end, "driver: " + call, "core: after " + end});
  return lines;
}

TEST(LifeCycle, EglsFencesAndImagesHoldWhatWasDrawnBefore) {
  EXPECT_THAT(play("egl_client", "published").lines(),
              ElementsAreArray(egl_with_frame_ends(
                  "wait", {"create sync", "client waits", "server waits", "create image",  // of EGL 1.5
                           "create sync", "create sync", "client waits", "server waits", "create image"})));
}

TEST(LifeCycle, EglsSwapsOfPartsEndFrames) {
  EXPECT_THAT(play("egl_client", "swapped_in_part").lines(),
              ElementsAreArray(
                  egl_with_frame_ends("swap", {"swap region of 20", "swap region of 20", "post part of 20"})));
}

TEST(LifeCycle, AnOpenGlEsContextIsAnnouncedAsSuch) {
  EXPECT_THAT(play("egl_client", "opengl_es").lines(),
              ElementsAre("driver: eglGetDisplay", "driver: create 1 share 0", "driver: current 1 drawable 20",
                          "core: open", "core: current 1 share 0 egl es drawable 20", "driver: glClear",
                          "core: before swap", "driver: swap 20", "core: after swap"));
}

TEST(LifeCycle, EglTerminateEndsTheContextsOfItsDisplay) {
  EXPECT_THAT(play("egl_client", "terminated").lines(),
              ElementsAre("driver: eglGetDisplay", "driver: create 1 share 0", "driver: create 2 share 1",
                          "driver: current 1 drawable 20", "core: open",
                          "core: current 1 share 0 egl desktop drawable 20", "core: before make_current",
                          "core: leaving after 0 calls", "driver: current 0 drawable 0", "driver: terminate",
                          "core: destroyed 1"));
}

TEST(LifeCycle, OsMesasFramesEndWhereTheImageIsAskedFor) {
  EXPECT_THAT(
      play("osmesa_client", "frames").lines(),
      ElementsAre("driver: OSMesa create 1 share 0", "driver: OSMesa current 1 of 2 x 2", "core: open",
                  "core: current 1 share 0 osmesa desktop drawable", "core: glClear",
                  "driver: OSMesa's glClear",                                         //
                  "core: glFlush", "driver: OSMesa's glFlush", "core: after finish",  //
                  "driver: OSMesa's glFinish",                                        // the same frame
                  "core: glClear", "driver: OSMesa's glClear",                        //
                  "core: before finish", "core: after finish", "core: before make_current",
                  "driver: OSMesa current 1 of 2 x 2",  // the same again: no change
                  "core: before finish", "core: before make_current", "core: leaving after 4 calls",
                  "driver: OSMesa current 1 of 3 x 2", "core: current 1 share 0 osmesa desktop drawable",
                  "core: before finish", "core: before make_current", "core: leaving after 0 calls",
                  "driver: OSMesa current 0 of 0 x 0",  //
                  "driver: OSMesa's glClear",           // this program's OpenGL; GLX is not opened
                  "driver: OSMesa destroy 1", "core: destroyed 1"));
}

TEST(LifeCycle, OsMesasContextsShare) {
  EXPECT_THAT(play("osmesa_client", "share_group").lines(),
              ElementsAre("driver: OSMesa create 1 share 0", "driver: OSMesa create 2 share 1",
                          "driver: OSMesa current 1 of 2 x 2", "core: open",
                          "core: current 1 share 0 osmesa desktop drawable",  //
                          "core: before finish", "core: before make_current", "core: leaving after 0 calls",
                          "driver: OSMesa current 2 of 2 x 2",
                          "core: current 2 share 1 osmesa desktop drawable",  //
                          "driver: OSMesa destroy 1", "core: destroyed 1",    //
                          "core: glClear", "driver: OSMesa's glClear", "app: glClear ours, glAccum null"));
}

// OSMesa frees a context at once, even if it is current.
TEST(LifeCycle, AnOsMesaContextDestroyedWhileCurrentIsReleased) {
  EXPECT_THAT(play("osmesa_client", "destroyed_while_current").lines(),
              ElementsAre("driver: OSMesa create 1 share 0", "driver: OSMesa current 1 of 2 x 2", "core: open",
                          "core: current 1 share 0 osmesa desktop drawable",  //
                          "core: glClear", "driver: OSMesa's glClear",        //
                          "core: before finish", "core: after finish", "core: before make_current",
                          "core: leaving after 1 calls", "driver: OSMesa destroy 1", "core: destroyed 1",
                          "driver: OSMesa create 1 share 0", "driver: OSMesa current 1 of 2 x 2",
                          "core: current 2 share 0 osmesa desktop drawable",  // not the dead one's chain
                          "core: glClear", "driver: OSMesa's glClear",        //
                          "core: before finish", "core: before make_current", "core: leaving after 1 calls",
                          "driver: OSMesa destroy 1", "core: destroyed 2",  //
                          "driver: OSMesa's glClear"));
}

TEST(LifeCycle, AddressesOfOsMesasBuffersAreGivenWithoutGlCalls) {
  EXPECT_THAT(play("osmesa_client", "buffers").lines(),
              ElementsAre("driver: OSMesa create 1 share 0", "driver: OSMesa current 1 of 2 x 2", "core: open",
                          "core: current 1 share 0 osmesa desktop drawable",     //
                          "core: before finish", "driver: OSMesa colours of 1",  //
                          "core: before finish", "driver: OSMesa depth of 1"));
}

// With all argument registers, and with arguments on the stack.
TEST(LifeCycle, AFunctionOutsideTheRegistryGetsItsArguments) {
  EXPECT_THAT(
      play("glx_client", "outside_registry").lines(),
      ElementsAre("driver: create 1 share 0", "driver: current 1 drawable 10", "core: open",
                  "core: current 1 share 0 glx desktop drawable 10",  //
                  "core: before wait",
                  "driver: glDrawMeshNV 1 2 3 4 5 6 7 8, 0.5 1.5 2.5 3.5 4.5 5.5 6.5 7.5 8.5",
                  "app: 4711",  //
                  "understudy: the application calls glGpuSyncAcquireNVX, which this OpenGL driver lacks; "
                  "such calls do nothing",
                  "app: 0"));
}

TEST(LifeCycle, AProgramOfOneWindowSystemLoadsThatOneAlone) {
  EXPECT_TRUE(play("glx_client", "libraries").says("driver's GLX loaded, EGL not loaded"));
  EXPECT_TRUE(play("egl_client", "libraries").says("driver's GLX not loaded, EGL loaded"));
}

}  // namespace
