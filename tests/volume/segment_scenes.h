// SPDX-License-Identifier: Apache-2.0
// Requests with surfaces, light and pre-integration, drawn by one rank or several.
#pragma once

#include "tests/volume/scenes.h"
#include "volume/footprint.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/kd_tree.h"
#include "volume/raycast/ray_caster.h"
#include "volume/raycast/segment_scene.h"
#include "volume/reference/segment_sum.h"
#include "volume/request.h"

namespace understudy::volume::testing {

/// An image of 40 x 34 pixels with steps of about one texel of a 40-texel volume, in a space stretched relative
/// to texture space.
inline RenderRequest request_on_steps(const Texture& texture) {
  RenderRequest request = request_for(texture, usual_camera(40, 34), 40, 34, 0);
  request.steps.emplace();
  request.steps->metric = {38, 3, 0, 0, 34, 0, 6, 0, 41};
  TransferFunction table = smooth_table(17, 0.1F);
  for (std::size_t i = 0; i < 4; ++i) table.entries[i] = {};
  request.classification = table;
  return request;
}

inline Light some_light() {
  Light light;
  light.space = {1.1, 0, 0.2, 0, 0.9, 0, 0, 0.1, 1};
  light.direction = {0.5, 2, 1};
  return light;
}

/// Sets the ghost layer that the request needs.
inline void give_ghost_layer(Texture& texture, const RenderRequest& request) {
  texture.description.ghost_layer = ghost_layer_needed(texture.description, request);
}

inline Image drawn(const Texture& texture, const RenderRequest& request, FrameCounts& counts) {
  Image image(request.window);
  raycast(filled(texture), request, image, counts);
  return image;
}

/// The images of `ranks` ranks, composited in visibility order.
inline Image drawn_in_parts(const Texture& texture, const RenderRequest& request, int ranks,
                            FrameCounts& counts) {
  const KdTree tree(texture.description, ranks);
  Image all(request.window);
  for (const int rank : tree.visibility_order(request)) {
    Image part(footprint(request, texture.description, tree.box(rank)));
    raycast(filled(texture, tree.box(rank)), request, part, counts);
    for (int y = part.rect.y; y < part.rect.y + part.rect.height; ++y)
      for (int x = part.rect.x; x < part.rect.x + part.rect.width; ++x) {
        const float room = 1 - all.at(x, y)[3];
        for (int k = 0; k < 4; ++k) all.at(x, y)[k] += room * part.at(x, y)[k];
      }
  }
  return all;
}

inline ReferenceImage expected(const Texture& texture, const RenderRequest& request) {
  return segment_sum(texture_field(texture.description, Filter::linear, texture.texels), texture.description,
                     request, request.window);
}

/// The last bits decide whether the field takes a value twice in one segment or only touches it.
constexpr int pixels_that_graze = 4;

}  // namespace understudy::volume::testing
