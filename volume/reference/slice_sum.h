// SPDX-License-Identifier: Apache-2.0
// What the application's samples mean, literally and in double precision: for every pixel the ordered
// composition of every plane that its ray meets, or of every step that it takes. Slow, plain and written
// independently of the ray caster, which is judged by it.
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

/// A field over texture space: normalised value in the first component, or RGBA. A NaN contributes nothing.
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

/// What light makes of the premultiplied colour of the sample at t, on a ray that goes along `way`.
using Shade =
    std::function<std::array<double, 4>(const Vec3& t, const Vec3& way, const std::array<double, 4>& colour)>;

/// Composes all planes (or steps) of `request` over the pixels of `rect` that lie in its window; terminates
/// early at the request's opacity limit alone. `shade` stands for the request's light; its method and surfaces
/// are not looked at. Throws std::invalid_argument when the matrix is singular.
ReferenceImage slice_sum(const Field& field, const RenderRequest& request, const Rect& rect,
                         const Shade& shade = {});

}  // namespace understudy::volume
