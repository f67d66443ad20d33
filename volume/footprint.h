// SPDX-License-Identifier: Apache-2.0
// The pixels that a box of texture space can cover.
#pragma once

namespace understudy::volume {

struct Box;
struct Rect;
struct RenderRequest;
struct TexelBox;
struct VolumeDescription;

/// Bounds all pixel centres whose ray intersects `box` within the request's region and between the near and far
/// planes; intersected with the request's window. Never too small, and at most one pixel too large on each side
/// unless the box reaches the eye. Empty when no part of the box is visible.
Rect footprint(const RenderRequest& request, const Box& box);

/// The same for the samples that fall in `cells` of `volume`. Empty boxes of cells have an empty footprint.
Rect footprint(const RenderRequest& request, const VolumeDescription& volume, const TexelBox& cells);

}  // namespace understudy::volume
