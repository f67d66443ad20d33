// SPDX-License-Identifier: Apache-2.0
// Nodes that cast rays on the CPU, in OpenGL, or by whichever is faster give the same images, and the report
// states which backend was used and why.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/clients/command_test.h"

namespace clients {
namespace {

using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class Backend : public CommandTest {
 protected:
  /// The last of `frames` frames on two nodes, and the report's lines on backends. The view changes in every
  /// frame, since an unchanged view would be drawn only once.
  std::vector<std::string> draw(const std::string& backend, const std::string& frames,
                                const std::string& image) {
    run_well(under({"-n", "2", "--backend", backend, "--report", file("r.json")}) +
             engine_viewer("table", {"--frames", frames, "--orbit", "60", "--screenshot", file(image)}));
    EXPECT_GT(substituted(json("r.json")), 0) << backend;
    return json("r.json")["backends"].get<std::vector<std::string>>();
  }
};

TEST_F(Backend, OfTheNodesIsToldAndDrawsTheSameImage) {
  if (const std::string reason = missing({Need::engine, Need::mpi}); !reason.empty()) GTEST_SKIP() << reason;
  EXPECT_THAT(draw("cpu", "1", "cpu.png"), IsEmpty());
  EXPECT_THAT(draw("gl", "1", "gl.png"), testing::AllOf(SizeIs(2), Each(HasSubstr("GL, as asked: "))));
  EXPECT_THAT(draw("gl:osmesa", "1", "osmesa.png"), testing::AllOf(SizeIs(2), Each(HasSubstr("on OSMesa"))));
  EXPECT_THAT(draw("auto", "7", "auto.png"),
              testing::AllOf(testing::Not(IsEmpty()), Each(HasSubstr("ns a sample"))));
  for (const char* image : {"gl.png", "osmesa.png", "auto.png"})
    EXPECT_LE(told(image, png("cpu.png"), png(image)).max, 1) << image;
  EXPECT_EQ(leftovers(), "");
}

}  // namespace
}  // namespace clients
