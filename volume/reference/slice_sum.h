// SPDX-License-Identifier: Apache-2.0
// Reference images of the application's samples, literally and in double precision: for every pixel, the
// samples on all planes that its ray crosses, or on all its steps, composited in order. Slow, simple and
// independent of the ray caster, which is tested against it.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "volume/description.h"
#include "volume/rect.h"
#include "volume/texture_space.h"

namespace understudy::volume {

struct RenderRequest;

/// A field over texture space: normalised value in the first component, or RGBA. NaN contributes nothing.
using Field = std::function<std::array<double, 4>(const Vec3& t)>;

/// The field of a texture: the texels of `volume.stored`, x fastest, under OpenGL's filter and wrap rules. A
/// linear sample whose cell has a NaN corner is NaN; infinite texels become huge. Copies the texels.
Field texture_field(const VolumeDescription& volume, Filter filter, std::span<const std::byte> texels);

struct ReferenceImage {
  Rect rect;
  std::vector<double> rgba;  ///< rows bottom up, premultiplied; pixels without samples as in neutral_value()

  const double* at(int x, int y) const {
    return rgba.data() + 4 * (std::size_t(y - rect.y) * std::size_t(rect.width) + std::size_t(x - rect.x));
  }
};

/// Lights the premultiplied colour of the sample at t, on a ray with direction `way`.
using Shade =
    std::function<std::array<double, 4>(const Vec3& t, const Vec3& way, const std::array<double, 4>& colour)>;

/// Composites all planes (or steps) of `request` over the pixels of `rect` that lie in its window; terminates
/// early only at the request's opacity limit. `shade` replaces the request's light; its method and surfaces are
/// ignored. Throws std::invalid_argument when the matrix is singular.
ReferenceImage slice_sum(const Field& field, const RenderRequest& request, const Rect& rect,
                         const Shade& shade = {});

}  // namespace understudy::volume
