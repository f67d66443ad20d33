// SPDX-License-Identifier: Apache-2.0
// Casts rays through a volume of 8-bit texels and writes the image as PPM: raycast [FILE] >image.ppm
#include <algorithm>
#include <cstdio>
#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/file/volume_file.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/opening/open_volume.h"
#include "volume/orbit_camera.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"
#include "volume/transfer_control_points.h"

using namespace understudy::volume;

int main(int argc, char** argv) {
  const auto file = open_volume(argc > 1 ? argv[1] : "synthetic:96x96x96:u8:shells");
  const FileDescription& about = file->description();
  const VolumeDescription volume{.size = about.size, .stored = {{}, about.size}};
  std::vector<std::byte> texels(texels_in(volume.stored));
  file->read(volume.stored, texels);

  BrickStore bricks(volume, cell_lattice(volume).box());
  bricks.add_slices(volume.stored, texels);
  bricks.finish();

  constexpr double step = 1;
  RenderRequest request = orbit_request(volume, about.spacing, {.azimuth = 30}, 400, 300, step);
  request.classification = sampled(control_points_named("engine"), 0, 1, step);
  Image image(request.window);
  FrameCounts counts;
  raycast(bricks, request, image, counts);

  std::printf("P6 %d %d 255\n", image.rect.width, image.rect.height);
  for (int y = image.rect.height - 1; y >= 0; --y)
    for (int x = 0; x < image.rect.width; ++x)
      for (int channel = 0; channel < 3; ++channel)
        std::putchar(int(std::clamp(image.at(x, y)[channel], 0.0F, 1.0F) * 255 + 0.5F));
}
