#include "spu/volume/verify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace understudy::spu {
namespace {

/// The application's blending with an alpha that goes the way of the colour, as the nodes' images have it.
class ColourBlending {
 public:
  ColourBlending(const DispatchTable& gl, const Blending& blending) : gl_(gl) {
    gl_.GetIntegerv(GL_BLEND_SRC_RGB, &factors_[0]);
    gl_.GetIntegerv(GL_BLEND_DST_RGB, &factors_[1]);
    gl_.GetIntegerv(GL_BLEND_SRC_ALPHA, &factors_[2]);
    gl_.GetIntegerv(GL_BLEND_DST_ALPHA, &factors_[3]);
    gl_.GetIntegerv(GL_BLEND_EQUATION_RGB, &equations_[0]);
    gl_.GetIntegerv(GL_BLEND_EQUATION_ALPHA, &equations_[1]);
    gl_.BlendEquation(GLenum(equations_[0]));
    if (blending.front_to_back != FrontToBack::no) {
      gl_.BlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE);
    } else {
      gl_.BlendFuncSeparate(GLenum(factors_[0]), GLenum(factors_[1]), GL_ONE,
                            blending.op == volume::Operator::add ? GL_ONE : GL_ONE_MINUS_SRC_ALPHA);
    }
  }
  ~ColourBlending() {
    gl_.BlendEquationSeparate(GLenum(equations_[0]), GLenum(equations_[1]));
    gl_.BlendFuncSeparate(GLenum(factors_[0]), GLenum(factors_[1]), GLenum(factors_[2]), GLenum(factors_[3]));
  }
  ColourBlending(const ColourBlending&) = delete;
  ColourBlending& operator=(const ColourBlending&) = delete;

 private:
  const DispatchTable& gl_;
  std::array<GLint, 4> factors_{};
  std::array<GLint, 2> equations_{};
};

}  // namespace

double Difference::psnr() const {
  return mean_square > 0 ? -10.0 * std::log10(mean_square) : std::numeric_limits<double>::infinity();
}

ApplicationDrawing::ApplicationDrawing(const GlContext& context, const Pipeline& pipeline,
                                       const volume::RenderRequest& request)
    : context_(context) {
  if (request.viewport.x < 0 || request.viewport.y < 0) return;
  const bool minimum = pipeline.blending.op == volume::Operator::min;
  framebuffer_.emplace(context, request.viewport.x + request.viewport.width,
                       request.viewport.y + request.viewport.height, pipeline.target.samples, request.depth,
                       minimum ? 1.0F : 0.0F);
}

void ApplicationDrawing::add(const Run& run) {
  if (!complete()) return;
  const DispatchTable& gl = *context_.gl;
  GLint bound = 0;
  gl.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_->name());
  {
    const ColourBlending blending(gl, run.pipeline().blending);
    run.replay(gl);
  }
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(bound));
}

ApplicationImage ApplicationDrawing::image(const volume::Rect& rect) const {
  const DispatchTable& gl = *context_.gl;
  std::array<GLint, 2> bound{};
  gl.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound[0]);
  gl.GetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &bound[1]);
  ApplicationImage drawn{rect, framebuffer_->pixels(rect)};
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(bound[0]));
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(bound[1]));
  return drawn;
}

std::optional<ApplicationImage> application_image(const GlContext& context, const Run& run,
                                                  const volume::RenderRequest& request,
                                                  const volume::Rect& rect) {
  if (rect.empty()) return std::nullopt;
  ApplicationDrawing drawing(context, run.pipeline(), request);
  drawing.add(run);
  if (!drawing.complete()) return std::nullopt;
  return drawing.image(rect);
}

Difference difference_between(const Pipeline& pipeline, const ApplicationImage& drawn,
                              const volume::ImageView& image) {
  const volume::Rect& rect = drawn.rect;
  const bool minimum = pipeline.blending.op == volume::Operator::min;
  const bool floating = pipeline.target.floating;
  const float largest =
      floating ? std::max(1.0F, *std::max_element(drawn.rgba.begin(), drawn.rgba.end())) : 1.0F;
  const auto shown = [&](float value) {
    const float seen = minimum ? std::min(value, 1.0F) : value;
    return floating ? double(seen) / largest : double(std::clamp(seen, 0.0F, 1.0F));
  };
  Difference difference;
  double sum = 0;
  const volume::Rect& inside = image.rect;
  for (std::size_t pixel = 0; pixel < rect.pixels(); ++pixel) {
    const int x = rect.x + int(pixel % std::size_t(rect.width)) - inside.x;
    const int y = rect.y + int(pixel / std::size_t(rect.width)) - inside.y;
    const bool known = x >= 0 && y >= 0 && x < inside.width && y < inside.height;
    const std::size_t at = 4 * (std::size_t(y) * std::size_t(inside.width) + std::size_t(x));
    for (std::size_t c = 0; c < 4; ++c) {
      const float ours = known ? image.rgba[at + c] : (minimum ? 1.0F : 0.0F);
      const double d = std::abs(shown(drawn.rgba[4 * pixel + c]) - shown(ours));
      difference.max = std::max(difference.max, d);
      sum += d * d;
    }
  }
  difference.mean_square = sum / double(4 * rect.pixels());
  return difference;
}

std::optional<Difference> compare_with_application(const GlContext& context, const Run& run,
                                                   const volume::RenderRequest& request,
                                                   const volume::ImageView& image) {
  const auto drawn = application_image(context, run, request, image.rect);
  if (!drawn) return std::nullopt;
  return difference_between(run.pipeline(), *drawn, image);
}

}  // namespace understudy::spu
