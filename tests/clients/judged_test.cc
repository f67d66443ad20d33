// SPDX-License-Identifier: Apache-2.0
// Every operator, opaque geometry and two volumes, compared with the slices in double precision: the viewer
// alone, with the ray caster in its process, and on two ranks; the composited float frames and the 8-bit
// images. Every channel of every pixel has its own bound, which follows from the precisions below
// (`tests/emulation/slices.h`).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/understudy/images/image.h"
#include "tests/clients/command_test.h"
#include "tests/emulation/precision.h"
#include "tests/emulation/viewer_frame.h"

namespace clients {
namespace {

using understudy::launcher::read_image;

using emulation::drivers;
using emulation::float_step;
using emulation::ours;
using emulation::ray_termination;

constexpr emulation::Rounding bytes = emulation::normalised(8, 8);
constexpr emulation::Rounding none{};

struct Scene {
  const char* name;
  const char* mode;
  Words options;
  int volumes = 1;
};

std::vector<double> screenshot(const viewer_test::Image& image) {
  std::vector<double> channels;
  for (const std::uint8_t channel : image.rgb) channels.push_back(channel / 255.0);
  return channels;
}

class Judged : public CommandTest, public testing::WithParamInterface<Scene> {
 protected:
  /// No voxel is 0, so that a minimum shows something. Has edges and smooth regions, and three different sizes.
  std::string volume() const {
    std::string voxels;
    for (int z = 0; z < 36; ++z)
      for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 44; ++x) {
          const double r = std::hypot((x - 21.0) / 44, (y - 18.0) / 40, (z - 16.0) / 36);
          const double wave = std::exp(-40 * (r - 0.3) * (r - 0.3)) * (0.7 + 0.3 * std::sin(0.6 * x + 0.3 * z));
          voxels.push_back(
              static_cast<char>(std::lround(40 + 180 * wave + (z / 6 % 2 == 0 && x > 24 ? 30 : 0))));
        }
    return folder_.write("waves.44x40x36", voxels);
  }

  Words viewer() const {
    return Words{(programs / "understudy-viewer").string(),
                 file("waves.44x40x36").string(),
                 "--mode",
                 GetParam().mode,
                 "--preset",
                 "engine",
                 "--offscreen",
                 "--no-frame",
                 "--window-size",
                 "160",
                 "120",
                 "--azimuth",
                 "35",
                 "--elevation",
                 "25",
                 "--distance",
                 "1.5",
                 "--background",
                 "0.2",
                 "0.4",
                 "0.6"} +
           GetParam().options;
  }

  /// Prints how `drawn` compares with `image`, and expects it within the bounds plus `slack`.
  void expect_within(const std::string& what, const emulation::Image& image, const std::vector<double>& drawn,
                     int channels, double slack) const {
    const emulation::Verdict verdict = emulation::judge(image, drawn, channels, slack);
    fmt::print("{}: RMS {:.2e}, max {:.2e}, beyond the bounds by {:.2e} ({} of {}), RMS of the bounds {:.2e}\n",
               what, verdict.rms, verdict.max, verdict.beyond, verdict.outside, drawn.size(), verdict.width);
    EXPECT_EQ(verdict.outside, 0) << what;
  }

  /// A volume's own image with its slices slightly displaced.
  static std::vector<double> moved(const emulation::Frame& frame, std::size_t number) {
    emulation::Volume volume = frame.volumes[number];
    const double distance = volume.offsets[1] - volume.offsets[0];
    for (double& offset : volume.offsets) offset += distance / 4;
    return emulation::meant(emulation::draw_alone(frame, volume, {}), 4);
  }
};

TEST_P(Judged, ImagesLieWithinTheBoundsOfTheirArithmetic) {
  volume();
  run_well(viewer() + Words{"--screenshot", file("bare.png"), "--describe", file("scene.json")});
  const emulation::Frame frame = emulation::viewer_frame(json("scene.json"));
  ASSERT_EQ(frame.volumes.size(), static_cast<std::size_t>(GetParam().volumes));
  const double slices = static_cast<double>(frame.volumes[0].offsets.size());

  expect_within("the viewer alone", emulation::draw(frame, drivers, bytes, none), screenshot(png("bare.png")),
                3, 1e-9);

  const emulation::Image shown = emulation::draw(frame, ours, none, emulation::presented(bytes));
  std::vector<emulation::Image> alone;
  for (const emulation::Volume& volume : frame.volumes)
    alone.push_back(emulation::draw_alone(frame, volume, ours));
  for (const char* ranks : {"0", "2"}) {
    if (*ranks != '0' && !missing({Need::mpi}).empty()) continue;
    const std::string name = fmt::format("{} ranks", ranks);
    const auto folder = file(name);
    const Outcome outcome =
        run_well(under({"-n", ranks, "--save-frames", folder, "--report", file("report.json")}) + viewer() +
                 Words{"--screenshot", file("under.png")});
    ASSERT_EQ(substituted(json("report.json")), GetParam().volumes) << outcome.err;
    expect_within(name + ", 8 bits", shown, screenshot(png("under.png")), 3, ray_termination);
    for (std::size_t number = 0; number < alone.size(); ++number) {
      const auto saved = read_image(folder / fmt::format("frame_{:04}.pfm", number));
      // Each blend rounds twice.
      double brightest = 1;
      for (const float value : saved.rgba)
        if (value < 1e30F) brightest = std::max<double>(brightest, value);
      const double slack = ray_termination + 2 * slices * float_step * brightest;
      expect_within(fmt::format("{}, float frame {}", name, number), alone[number],
                    {saved.rgba.begin(), saved.rgba.end()}, 4, slack);
      EXPECT_GT(emulation::judge(alone[number], moved(frame, number), 4, slack).outside, 100)
          << "slices a quarter of their distance away would go unnoticed";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, Judged,
    testing::Values(
        Scene{"OverRgba", "rgba", {}}, Scene{"OverTable", "table", {}}, Scene{"OverCore", "core", {}},
        Scene{"UnderRgba", "rgba", {"--operator", "under"}},
        Scene{"UnderTable", "table", {"--operator", "under"}},
        Scene{"UnderCore", "core", {"--operator", "under"}},
        Scene{"MaximumRgba", "rgba", {"--operator", "max"}},
        Scene{"MaximumTable", "table", {"--operator", "max"}},
        Scene{"MaximumCore", "core", {"--operator", "max"}},
        Scene{"MinimumRgba", "rgba", {"--operator", "min"}},
        Scene{"MinimumTable", "table", {"--operator", "min"}},
        Scene{"MinimumCore", "core", {"--operator", "min"}}, Scene{"SumRgba", "rgba", {"--operator", "add"}},
        Scene{"SumTable", "table", {"--operator", "add"}}, Scene{"SumCore", "core", {"--operator", "add"}},
        Scene{"BallRgba", "rgba", {"--opaque"}}, Scene{"BallTable", "table", {"--opaque"}},
        Scene{"BallCore", "core", {"--opaque"}}, Scene{"BallInParallelRgba", "rgba", {"--opaque", "--ortho"}},
        Scene{"BallInParallelCore", "core", {"--opaque", "--ortho"}},
        Scene{"BallUnder", "table", {"--opaque", "--operator", "under"}},
        Scene{"BallMaximum", "table", {"--opaque", "--operator", "max"}},
        Scene{"BallMinimum", "core", {"--opaque", "--operator", "min"}},
        Scene{"BallSum", "rgba", {"--opaque", "--operator", "add"}}, Scene{"TwoRgba", "rgba", {"--second"}, 2},
        Scene{"TwoTable", "table", {"--second"}, 2}, Scene{"TwoCore", "core", {"--second", "--opaque"}, 2},
        Scene{"TwoUnder", "core", {"--second", "--operator", "under"}, 2},
        Scene{"TwoSums", "table", {"--second", "--operator", "add", "--ortho"}, 2},
        Scene{"TwoMaxima", "core", {"--second", "--operator", "max"}, 2},
        Scene{"TwoMinima", "rgba", {"--second", "--operator", "min"}, 2}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace clients
