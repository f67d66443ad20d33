#include "spu/volume/verify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "spu/volume/saved_state.h"

namespace understudy::spu {
namespace {

/// A float framebuffer with depth that covers the application's viewport.
class FloatFramebuffer {
 public:
  FloatFramebuffer(const GlContext& context, int width, int height,
                   const std::optional<volume::DepthImage>& depth)
      : gl_(*context.gl) {
    SavedState saved(context);
    saved.borrow_texture(GL_TEXTURE_2D, 0);
    gl_.ActiveTexture(GL_TEXTURE0);
    gl_.GenTextures(2, textures_.data());
    gl_.BindTexture(GL_TEXTURE_2D, textures_[0]);
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, nullptr);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl_.BindTexture(GL_TEXTURE_2D, textures_[1]);
    const std::vector<float> far(std::size_t(width) * std::size_t(height), 1.0F);
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, width, height, 0, GL_DEPTH_COMPONENT, GL_FLOAT,
                   far.data());
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    if (depth) {
      gl_.TexSubImage2D(GL_TEXTURE_2D, 0, depth->rect.x, depth->rect.y, depth->rect.width, depth->rect.height,
                        GL_DEPTH_COMPONENT, GL_FLOAT, depth->depth.data());
    }
    gl_.GenFramebuffers(1, &name_);
    gl_.BindFramebuffer(GL_FRAMEBUFFER, name_);
    gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, textures_[0], 0);
    gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, textures_[1], 0);
    complete_ = gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
    constexpr std::array<float, 4> transparent{};
    if (complete_) gl_.ClearBufferfv(GL_COLOR, 0, transparent.data());
  }
  ~FloatFramebuffer() {
    gl_.DeleteFramebuffers(1, &name_);
    gl_.DeleteTextures(2, textures_.data());
  }
  FloatFramebuffer(const FloatFramebuffer&) = delete;
  FloatFramebuffer& operator=(const FloatFramebuffer&) = delete;

  bool complete() const { return complete_; }
  GLuint name() const { return name_; }

 private:
  const DispatchTable& gl_;
  std::array<GLuint, 2> textures_{};
  GLuint name_ = 0;
  bool complete_ = false;
};

}  // namespace

double Difference::psnr() const {
  return mean_square > 0 ? -10.0 * std::log10(mean_square) : std::numeric_limits<double>::infinity();
}

std::optional<std::vector<float>> application_picture(const GlContext& context, const Run& run,
                                                      const volume::RenderRequest& request,
                                                      const volume::Rect& rect) {
  const DispatchTable& gl = *context.gl;
  if (rect.empty() || request.viewport.x < 0 || request.viewport.y < 0) return std::nullopt;
  const int width = request.viewport.x + request.viewport.width;
  const int height = request.viewport.y + request.viewport.height;
  const FloatFramebuffer framebuffer(context, width, height, request.depth);
  if (!framebuffer.complete()) return std::nullopt;

  std::array<GLint, 2> bound{};
  std::array<GLint, 4> factors{};
  gl.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound[0]);
  gl.GetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &bound[1]);
  gl.GetIntegerv(GL_BLEND_SRC_RGB, &factors[0]);
  gl.GetIntegerv(GL_BLEND_DST_RGB, &factors[1]);
  gl.GetIntegerv(GL_BLEND_SRC_ALPHA, &factors[2]);
  gl.GetIntegerv(GL_BLEND_DST_ALPHA, &factors[3]);
  // Alpha as coverage, whatever factors the application has for its own framebuffer's alpha.
  gl.BlendFuncSeparate(GLenum(factors[0]), GLenum(factors[1]), GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
  run.replay(gl);
  std::vector<float> drawn(4 * rect.pixels());
  {
    const SavedState saved(context);
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer.name());
    gl.ReadPixels(rect.x, rect.y, rect.width, rect.height, GL_RGBA, GL_FLOAT, drawn.data());
  }
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(bound[0]));
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(bound[1]));
  gl.BlendFuncSeparate(GLenum(factors[0]), GLenum(factors[1]), GLenum(factors[2]), GLenum(factors[3]));

  return drawn;
}

Difference difference_between(const volume::Rect& rect, std::span<const float> drawn,
                              const volume::ImageView& image) {
  Difference difference;
  const volume::Rect& inside = image.rect;
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    for (int x = rect.x; x < rect.x + rect.width; ++x) {
      const bool known =
          x >= inside.x && y >= inside.y && x < inside.x + inside.width && y < inside.y + inside.height;
      const std::size_t ours =
          4 * (std::size_t(y - inside.y) * std::size_t(inside.width) + std::size_t(x - inside.x));
      const std::size_t theirs =
          4 * (std::size_t(y - rect.y) * std::size_t(rect.width) + std::size_t(x - rect.x));
      for (std::size_t c = 0; c < 4; ++c) {
        const double d = std::abs(double(drawn[theirs + c]) - (known ? double(image.rgba[ours + c]) : 0.0));
        difference.max = std::max(difference.max, d);
        difference.mean_square += d * d;
      }
    }
  }
  difference.mean_square /= double(drawn.size());
  return difference;
}

std::optional<Difference> compare_with_application(const GlContext& context, const Run& run,
                                                   const volume::RenderRequest& request,
                                                   const volume::ImageView& image) {
  const auto drawn = application_picture(context, run, request, image.rect);
  if (!drawn) return std::nullopt;
  return difference_between(image.rect, *drawn, image);
}

}  // namespace understudy::spu
