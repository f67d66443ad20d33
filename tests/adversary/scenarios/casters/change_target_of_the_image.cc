// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {
namespace {

struct ImageTarget {
  GLuint framebuffer = 0, texture = 0;
  int width, height;

  ImageTarget(const Canvas& canvas, GLenum format, int w, int h) : width(w), height(h) {
    const Gl& gl = canvas.gl;
    gl.GenTextures(1, &texture);
    gl.ActiveTexture(GL_TEXTURE5);
    gl.BindTexture(GL_TEXTURE_2D, texture);
    filter_linearly(canvas, GL_TEXTURE_2D, GL_NEAREST);
    gl.TexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(canvas.colour_format(format)), w, h, 0, GL_RGBA,
                  GL_FLOAT, nullptr);
    gl.GenFramebuffers(1, &framebuffer);
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
  }

  void begin(const Canvas& canvas, float red, float green, float blue, float alpha) const {
    canvas.gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    canvas.gl.Viewport(0, 0, width, height);
    canvas.gl.ClearColor(red, green, blue, alpha);
    canvas.gl.Clear(GL_COLOR_BUFFER_BIT);
  }

  void blit(const Canvas& canvas, GLenum filter) const {
    canvas.begin();
    canvas.gl.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    canvas.gl.BlitFramebuffer(0, 0, width, height, 0, 0, canvas.width(), canvas.height(), GL_COLOR_BUFFER_BIT,
                              filter);
    canvas.gl.BindFramebuffer(GL_FRAMEBUFFER, canvas.framebuffer());
  }
};

}  // namespace

Scenario change_target_of_the_image() {
  return {
      .sentence =
          "Into the window until frame 11; then into an RGBA8 texture that is blitted; from frame 18 on into a "
          "transparent RGBA16F texture that is composed over the window's colour; from frame 24 on into an "
          "RGBA8 "
          "texture of half the size, that a linear blit enlarges, in every even frame, and the window in odd "
          "ones.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {12, 18, 24, 25, 26, 27, 28, 29},
      .start = [](Canvas& canvas) -> DrawFrame {
        const Field galaxy = [](float x, float y, float z) {
          const float a = x - 0.5F, b = 2.5F * (y - 0.5F), c = z - 0.5F;
          const float distance = std::sqrt(a * a + c * c);
          const float arms = 0.5F + 0.5F * std::sin(2 * std::atan2(c, a) + 16 * distance);
          return (0.3F + 0.7F * arms) * std::exp(-3 * (distance * distance + b * b)) * 0.85F +
                 0.1F * (0.5F + 0.5F * std::sin(12 * x + 9 * y + 4 * z));
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          table.push_back(
              {static_cast<std::uint8_t>(80 + 175 * at), static_cast<std::uint8_t>(60 + 150 * at * at),
               static_cast<std::uint8_t>(230 - 120 * at), static_cast<std::uint8_t>(std::lround(50 * at))});
        }
        auto scene =
            caster_scene(canvas, {.grid = sampled(48, 40, 52, galaxy),
                                  .table = table,
                                  .step_length = 0.019F,
                                  .orbit = {.azimuth = -60, .elevation = 38, .degrees_each_frame = 2}});
        const int w = canvas.width(), h = canvas.height();
        auto bytes = std::make_shared<ImageTarget>(canvas, GL_RGBA8, w, h);
        auto halves = std::make_shared<ImageTarget>(canvas, GL_RGBA16F, w, h);
        auto small = std::make_shared<ImageTarget>(canvas, GL_RGBA8, w / 2, h / 2);
        auto copy = std::make_shared<GlslProgram>(canvas, R"(#version 330 core
in vec3 position;
void main() { gl_Position = vec4(position, 1.0); }
)",
                                                  R"(#version 330 core
uniform sampler2D image;
out vec4 c;
void main() { c = texelFetch(image, ivec2(gl_FragCoord.xy), 0); }
)");
        return [&canvas, scene, bytes, halves, small, copy](int frame) {
          const Camera camera = scene->camera(frame);
          if (frame < 12 || (frame >= 24 && frame % 2 == 1)) {
            scene->draw(frame);
          } else if (frame < 18) {
            bytes->begin(canvas, 0.1F, 0.12F, 0.2F, 1);
            scene->draw_box(camera);
            bytes->blit(canvas, GL_NEAREST);
          } else if (frame < 24) {
            halves->begin(canvas, 0, 0, 0, 0);
            scene->draw_box(camera);
            canvas.begin(0.1F, 0.12F, 0.2F);
            canvas.gl.ActiveTexture(GL_TEXTURE5);
            canvas.gl.BindTexture(GL_TEXTURE_2D, halves->texture);
            copy->use();
            copy->set("image", 5);
            set_blending(canvas.gl, Blending::premultiplied_over);
            scene->vertices.draw(std::array<Vector, 3>{Vector{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}});
          } else {
            small->begin(canvas, 0.1F, 0.12F, 0.2F, 1);
            scene->draw_box(camera);
            small->blit(canvas, GL_LINEAR);
          }
        };
      }};
}

}  // namespace adversary::casters
