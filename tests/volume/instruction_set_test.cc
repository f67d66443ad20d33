// SPDX-License-Identifier: Apache-2.0
// The image is the same on every instruction set that this machine can run, and equals that of the plain
// kernel.
#include <gmock/gmock.h>
#include <hwy/targets.h>

#include <algorithm>
#include <fstream>
#include <initializer_list>
#include <string>

#include "tests/volume/scenes.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/kd_tree.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

/// Restricts Highway to one instruction set.
class OnlyTarget {
 public:
  explicit OnlyTarget(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
  ~OnlyTarget() {
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
  OnlyTarget(const OnlyTarget&) = delete;
  OnlyTarget& operator=(const OnlyTarget&) = delete;
};

struct Drawn {
  std::string instruction_set;
  Image image;
  FrameCounts counts;
};

/// One image per instruction set; the plain kernel's comes first.
std::vector<Drawn> draw_on_all(const BrickStore& store, const RenderRequest& request) {
  const std::int64_t here = hwy::SupportedTargets();
  std::vector<Drawn> all;
  for (const std::int64_t target : {HWY_EMU128, HWY_SSE4, HWY_AVX2, HWY_AVX3}) {
    if (target != HWY_EMU128 && (here & target) == 0) continue;
    const OnlyTarget only(target);
    Drawn drawn{instruction_set(), Image(request.window), {}};
    raycast(store, request, drawn.image, drawn.counts);
    all.push_back(std::move(drawn));
  }
  return all;
}

/// Whether /proc/cpuinfo lists all `flags` for the first processor.
bool processor_has(std::initializer_list<const char*> flags) {
  std::ifstream file("/proc/cpuinfo");
  std::string line;
  while (std::getline(file, line) && !line.starts_with("flags")) {
  }
  return std::ranges::all_of(flags, [&](const char* flag) {
    return (line + " ").find(std::string(" ") + flag + " ") != std::string::npos;
  });
}

// A Highway release that added targets once disabled the vector kernels: images silently took twelve times as
// long.
TEST(InstructionSets, ChosenIsTheBestThatTheProcessorHas) {
  const char* best = "";
  if (processor_has({"sse4_1", "sse4_2", "aes", "pclmulqdq"})) best = "SSE4";
  if ((HWY_TARGETS & HWY_AVX2) != 0 && processor_has({"avx2", "fma", "bmi1", "bmi2", "f16c"})) best = "AVX2";
  if ((HWY_TARGETS & HWY_AVX3) != 0 &&
      processor_has({"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"}))
    best = "AVX3";
  EXPECT_THAT(instruction_set(), ::testing::StartsWith(best)) << "AVX3_DL and others are kinds of AVX3";
}

TEST(InstructionSets, AllDrawTheSameImage) {
  double worst = 0;
  std::string seen;
  for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32, TexelType::rgba8})
    for (const Operator op : {Operator::over, Operator::max, Operator::min, Operator::add, Operator::first_hit})
      for (const Filter filter : {Filter::linear, Filter::nearest}) {
        const Texture texture = sampled(describe({45, 38, 51}, type, Wrap::border), sphere_field(0.3));
        RenderRequest request = request_for(texture, usual_camera(45, 39), 45, 39, 90);
        request.op = op;
        request.filter = filter;
        TransferFunction table = smooth_table();
        for (int i = 0; i < 40; ++i) table.entries[std::size_t(i)] = {};
        if (type != TexelType::rgba8) request.classification = table;
        if (op == Operator::over && filter == Filter::linear)
          request.fog = Fog{{1, 0.5, 0}, -0.2, {{0, 0, 0, 1}, {0, 0.2F, 0.4F, 0.6F}, {0.5F, 0.5F, 0.5F, 0}}};
        const BrickStore store = filled(texture);
        const auto all = draw_on_all(store, request);
        for (const Drawn& drawn : all) {
          const double d = difference(drawn.image, all[0].image).max;
          if (op != Operator::first_hit) worst = std::max(worst, d);
          if (op == Operator::first_hit) {
            // The last bit of a value decides which sample is the first visible one.
            EXPECT_LE(difference(drawn.image, all[0].image, 3e-5).pixels_over, 3)
                << drawn.instruction_set << ", texels " << int(type) << ", filter " << int(filter);
          } else {
            EXPECT_LE(d, 3e-5) << drawn.instruction_set;
          }
          EXPECT_EQ(drawn.counts.samples, all[0].counts.samples) << drawn.instruction_set;
          EXPECT_EQ(drawn.counts.rays, all[0].counts.rays) << drawn.instruction_set;
          if (seen.find(drawn.instruction_set) == std::string::npos) seen += drawn.instruction_set + " ";
        }
      }
  std::printf("%s: largest difference %.2e\n", seen.c_str(), worst);
}

TEST(InstructionSets, AllRoundSamplesOfBytesAlike) {
  const Texture texture = noise(describe({45, 38, 51}, TexelType::u8, Wrap::edge), 72);
  const Field field = texture_field(texture.description, Filter::linear_8_bit, texture.texels);
  for (const Operator op : {Operator::over, Operator::max, Operator::min, Operator::add}) {
    RenderRequest request = request_for(texture, usual_camera(45, 39), 45, 39, 90);
    request.op = op;
    request.filter = Filter::linear_8_bit;
    // Every byte has a colour that differs from its neighbours'.
    TransferFunction table;
    for (int i = 0; i < 256; ++i) {
      const float opacity = 0.02F * float(i % 2);
      table.entries.push_back({opacity, opacity * float(i % 3) / 2, opacity * float(i % 5) / 4, opacity});
    }
    request.classification = table;
    const ReferenceImage exact = slice_sum(field, request, request.window);
    const std::vector<Drawn> all = draw_on_all(filled(texture), request);
    for (const Drawn& drawn : all)
      EXPECT_LE(difference(drawn.image, all[0].image).max, 3e-5) << drawn.instruction_set;
    // Positions in float and in double differ, so that some samples are rounded to a different step.
    const double rounded_apart = difference(all[0].image, exact).rms;
    EXPECT_LE(rounded_apart, 1e-3) << "operator " << int(op);
    request.filter = Filter::linear;
    EXPECT_GT(difference(draw_on_all(filled(texture), request).back().image, exact).rms, 1.5 * rounded_apart);
  }
}

TEST(InstructionSets, MixedRanksStillCountEverySampleOnce) {
  // Ranks on different machines must agree exactly on which rank owns a sample.
  const Texture texture = noise(describe({37, 29, 41}, TexelType::u8), 71);
  const RenderRequest request = request_for(texture, usual_camera(45, 39), 45, 39, 300);
  FrameCounts whole, parts;
  Image image(request.window);
  raycast(filled(texture), request, image, whole);
  const KdTree tree(texture.description, 5);
  const std::int64_t here = hwy::SupportedTargets();
  const std::int64_t targets[] = {HWY_EMU128, HWY_SSE4, HWY_AVX2, HWY_EMU128, HWY_AVX3};
  for (int rank = 0; rank < tree.ranks(); ++rank) {
    const std::int64_t target = targets[rank];
    const OnlyTarget only(target == HWY_EMU128 || (here & target) ? target : HWY_EMU128);
    raycast(filled(texture, tree.box(rank)), request, image, parts);
  }
  EXPECT_EQ(parts.samples, whole.samples);
}

}  // namespace
}  // namespace understudy::volume::testing
