// SPDX-License-Identifier: Apache-2.0
// The pixels that a box of texture space can touch.
#pragma once

namespace understudy::volume {

struct Box;
struct Rect;
struct RenderRequest;
struct TexelBox;
struct VolumeDescription;

/// Bounds every pixel centre whose ray meets `box` within the request's region and between the near and far
/// plane; intersected with the request's window. Never too small, at most a pixel too large on each side,
/// except where the box reaches the eye. Empty when nothing of the box can be seen.
Rect footprint(const RenderRequest& request, const Box& box);

/// The same for the samples that fall in `cells` of `volume`; empty cells have an empty footprint.
Rect footprint(const RenderRequest& request, const VolumeDescription& volume, const TexelBox& cells);

}  // namespace understudy::volume
