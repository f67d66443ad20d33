// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"

namespace adversary::slices {
namespace {

struct HeartCorner {
  Vector place, texture;
};

struct HeartRegion {
  Vector low, high;
};

float heart(float x, float y, float z) {
  const float u = 2.4F * (x - 0.5F), v = 2.4F * (y - 0.45F), w = 2.4F * (z - 0.5F);
  const float wall = u * u + 1.3F * v * v + w * w + 0.35F * std::sin(4 * u + 3 * w);
  return std::clamp(0.45F + 0.4F * std::sin(6 * wall) + 0.25F * (waves(x, y, z) - 0.5F), 0.0F, 1.0F);
}

std::vector<Colour> chambers() {
  std::vector<Colour> colours;
  for (int i = 0; i < 256; ++i) {
    const float at = static_cast<float>(i) / 255;
    const float tissue = std::clamp((at - 0.45F) / 0.1F, 0.0F, 1.0F);
    colours.push_back({static_cast<std::uint8_t>(90 + 150 * at),
                       static_cast<std::uint8_t>(60 + 100 * (1 - tissue)),
                       static_cast<std::uint8_t>(200 * (1 - at)), static_cast<std::uint8_t>(6 + 80 * tissue)});
  }
  return colours;
}

class HeartViewer {
 public:
  explicit HeartViewer(Canvas& canvas)
      : gl_(canvas.gl),
        program(canvas, R"(#version 150
in vec3 position;
in vec3 coordinate;
uniform mat4 projection, view;
out vec3 stp;
void main() {
  stp = coordinate;
  gl_Position = projection * view * vec4(position, 1.0);
}
)",
                R"(#version 150
uniform sampler3D image;
uniform sampler2D lookup;
in vec3 stp;
out vec4 result;
void main() {
  float i = texture(image, stp).r;
  vec4 rgba = texture(lookup, vec2((i * 255.0 + 0.5) / 256.0, 0.5));
  if (rgba.a <= 0.03) discard;
  result = rgba;
}
)") {
    upload_volume(canvas, 0, sampled(40, 56, 48, heart));
    upload_table_2d(canvas, 1, chambers());
    gl_.GenVertexArrays(1, &array_);
    gl_.GenBuffers(1, &buffer_);
  }

  /// The planes lie as they would for the whole volume, and are cut to the region.
  void draw(const Camera& camera, const HeartRegion& region, int count) const {
    const Vector n = camera.forward, size = region.high - region.low;
    const Vector normal{n.x * size.x, n.y * size.y, n.z * size.z};
    std::vector<HeartCorner> corners;
    std::vector<GLsizei> sizes;
    for (int i = 0; i < count; ++i) {
      const float away = (0.5F - (static_cast<float>(i) + 0.5F) / static_cast<float>(count)) * std::sqrt(3.0F);
      const float distance = dot(n, {0.5F, 0.5F, 0.5F}) + away;
      const Polygon polygon = cut_box(normal, distance - dot(n, region.low));
      if (polygon.size() < 3) continue;
      sizes.push_back(static_cast<GLsizei>(polygon.size()));
      for (const Vector q : polygon) {
        const Vector t = region.low + Vector{q.x * size.x, q.y * size.y, q.z * size.z};
        corners.push_back({t, t});
      }
    }
    gl_.BindVertexArray(array_);
    gl_.BindBuffer(GL_ARRAY_BUFFER, buffer_);
    gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof(HeartCorner)),
                   corners.data(), GL_DYNAMIC_DRAW);
    gl_.EnableVertexAttribArray(0);
    gl_.EnableVertexAttribArray(1);
    gl_.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(HeartCorner), nullptr);
    gl_.VertexAttribPointer(
        1, 3, GL_FLOAT, GL_FALSE, sizeof(HeartCorner),
        reinterpret_cast<const void*>(sizeof(Vector)));  // NOLINT(performance-no-int-to-ptr)
    GLint first = 0;
    for (const GLsizei size_of_one : sizes) {
      gl_.DrawArrays(GL_TRIANGLE_FAN, first, size_of_one);
      first += size_of_one;
    }
  }

 private:
  const Gl& gl_;
  GLuint array_ = 0, buffer_ = 0;

 public:
  GlslProgram program;
};

}  // namespace

Scenario stack_heart_region_in_viewport() {
  return {.sentence =
              "A region of interest, cut by the polygons' own texture coordinates and changed every sixth "
              "frame, in a "
              "viewport and scissor box over a part of the window; one draw for each slice.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {6, 12, 18, 24},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, viewer = std::make_shared<HeartViewer>(canvas)](int frame) {
              const Gl& gl = canvas.gl;
              const int w = canvas.width(), h = canvas.height();
              canvas.begin(0.35F, 0.35F, 0.37F);
              const int left = w / 5, below = h / 8, wide = w - left, tall = h - 2 * below;
              gl.Enable(GL_SCISSOR_TEST);
              gl.Scissor(left, below, wide - 4, tall);
              gl.ClearColor(0, 0, 0, 1);
              gl.Clear(GL_COLOR_BUFFER_BIT);
              gl.Viewport(left, below, wide, tall);
              const Camera camera =
                  camera_at({.azimuth = 110, .elevation = -15, .distance = 2.2F, .degrees_each_frame = 3},
                            frame, static_cast<float>(wide) / static_cast<float>(tall));
              constexpr HeartRegion regions[5] = {{{0, 0, 0}, {1, 1, 1}},
                                                  {{0.1F, 0.2F, 0}, {0.75F, 1, 0.9F}},
                                                  {{0.1F, 0.2F, 0.3F}, {0.75F, 0.8F, 0.9F}},
                                                  {{0, 0, 0.45F}, {1, 1, 0.62F}},
                                                  {{0.3F, 0, 0}, {1, 0.7F, 1}}};
              viewer->program.use();
              viewer->program.set("image", 0);
              viewer->program.set("lookup", 1);
              viewer->program.set("projection", camera.projection);
              viewer->program.set("view", camera.view);
              gl.Enable(GL_BLEND);
              gl.BlendEquation(GL_FUNC_ADD);
              gl.BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
              viewer->draw(camera, regions[frame / 6 % 5], 80);
              gl.Disable(GL_SCISSOR_TEST);
            };
          }};
}

}  // namespace adversary::slices
