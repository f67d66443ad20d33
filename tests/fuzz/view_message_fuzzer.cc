// SPDX-License-Identifier: Apache-2.0
// Arbitrary requests of pages to `understudy view`: each is refused, or yields a valid camera and transfer
// function.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "apps/understudy/view/view_message.h"
#include "volume/request.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace understudy;
  launcher::ViewMessage message;
  try {
    message = launcher::decode_view_message({reinterpret_cast<const char*>(data), size});
  } catch (const launcher::MalformedView&) {
    return 0;
  }
  launcher::ViewCamera camera = message.camera.value_or(launcher::ViewCamera());
  if (message.rotate) camera = rotated(camera, (*message.rotate)[0], (*message.rotate)[1]);
  if (message.pan) camera = panned(camera, *message.pan);
  if (message.zoom) camera = zoomed(camera, message.zoom->by, message.zoom->at);
  volume::VolumeDescription description;
  description.size = {3, 4, 5};
  const auto size_asked = message.size.value_or(std::array{64, 64});
  volume::RenderRequest request = volume::orbit_request(description, {1, 1, 1}, camera.orbit, size_asked[0],
                                                        size_asked[1], message.step.value_or(1));
  launcher::shift(request, camera.shift);
  for (const double value : request.texture_to_clip)
    if (!std::isfinite(value)) std::abort();
  if (message.table) volume::sampled(*message.table, 0, 255, message.step.value_or(1));
  return 0;
}
