#include "spu/volume/pipeline.h"

namespace understudy::spu {
namespace {

GLint integer(const DispatchTable& gl, GLenum name) {
  GLint value = 0;
  gl.GetIntegerv(name, &value);
  return value;
}

GLenum binding_of(GLenum target) {
  switch (target) {
    case GL_TEXTURE_1D:
      return GL_TEXTURE_BINDING_1D;
    case GL_TEXTURE_2D:
      return GL_TEXTURE_BINDING_2D;
    case GL_TEXTURE_3D:
      return GL_TEXTURE_BINDING_3D;
    case GL_TEXTURE_RECTANGLE:
      return GL_TEXTURE_BINDING_RECTANGLE;
    default:
      return 0;
  }
}

GLuint bound_texture(const DispatchTable& gl, GLenum target, int unit) {
  const GLint active = integer(gl, GL_ACTIVE_TEXTURE);
  gl.ActiveTexture(GLenum(GL_TEXTURE0 + unit));
  const GLint texture = integer(gl, binding_of(target));
  gl.ActiveTexture(GLenum(active));
  return GLuint(texture);
}

/// Texture target of a sampler uniform's type; 0 for samplers that volume viewers' tables do not use.
GLenum target_of_sampler(GLenum type) {
  switch (type) {
    case GL_SAMPLER_1D:
      return GL_TEXTURE_1D;
    case GL_SAMPLER_2D:
      return GL_TEXTURE_2D;
    case GL_SAMPLER_3D:
      return GL_TEXTURE_3D;
    case GL_SAMPLER_2D_RECT:
      return GL_TEXTURE_RECTANGLE;
    default:
      return 0;
  }
}

/// The one 3-D texture and the tables that a program samples; a reason where that is not the shape of it.
std::optional<std::string> read_program_textures(const GlContext& context, const ShareGroup& group,
                                                 ProgramSamplers& samplers, Pipeline& pipeline) {
  const DispatchTable& gl = *context.gl;
  const std::shared_ptr<const ProgramRecord> record = group.programs().program(pipeline.program);
  if (record == nullptr) return std::nullopt;  // never linked in our sight: no 3-D sampler known
  int volumes = 0;
  for (const SamplerUniform& sampler : samplers.of(gl, pipeline.program, record->link)) {
    const GLenum target = target_of_sampler(sampler.type);
    GLint unit = 0;
    gl.GetUniformiv(pipeline.program, sampler.location, &unit);
    if (target == 0) continue;
    SampledTexture sampled{target, unit, bound_texture(gl, target, unit), sampler.location};
    // A 3-D sampler without a texture (a mask that is not in use) gives the same everywhere: PyMOL has one.
    if (target == GL_TEXTURE_3D && sampled.texture != 0) {
      ++volumes;
      pipeline.volume = sampled;
    } else {
      pipeline.others.push_back(sampled);
    }
  }
  if (volumes > 1) return "the program samples more than one 3-D texture";
  if (volumes == 1) {
    if (!record->fragment_source_known) return "the program's fragment shader source is not known";
    if (record->other_stages) return "the program has geometry or tessellation stages";
    pipeline.vertex_shader = record->vertex_shader;
  }
  return std::nullopt;
}

std::optional<std::string> read_fixed_function_textures(const GlContext& context, Pipeline& pipeline) {
  const DispatchTable& gl = *context.gl;
  const GLint active = integer(gl, GL_ACTIVE_TEXTURE);
  int enabled_units = 0;
  for (int unit = 0; unit < context.fixed_function_units; ++unit) {
    gl.ActiveTexture(GLenum(GL_TEXTURE0 + unit));
    if (gl.IsEnabled(GL_TEXTURE_3D)) {
      pipeline.volume = {GL_TEXTURE_3D, unit, GLuint(integer(gl, GL_TEXTURE_BINDING_3D)), -1};
      ++enabled_units;
    } else if (gl.IsEnabled(GL_TEXTURE_2D) || gl.IsEnabled(GL_TEXTURE_1D) ||
               gl.IsEnabled(GL_TEXTURE_CUBE_MAP)) {
      ++enabled_units;
    }
  }
  gl.ActiveTexture(GLenum(active));
  if (pipeline.volume.texture == 0) return std::nullopt;
  if (enabled_units > 1) return "more than one texture unit takes part in fixed function";
  if (pipeline.volume.unit != 0) return "the volume is not on texture unit 0 in fixed function";
  if (gl.IsEnabled(GL_FRAGMENT_PROGRAM_ARB) || gl.IsEnabled(GL_VERTEX_PROGRAM_ARB)) {
    return "an ARB assembly program is enabled";
  }
  if (gl.IsEnabled(GL_FOG)) return "fog is enabled";
  return std::nullopt;
}

/// Bits of alpha in the framebuffer bound for drawing.
GLint alpha_bits(const DispatchTable& gl) {
  GLint buffer = 0;
  gl.GetIntegerv(GL_DRAW_BUFFER0, &buffer);
  if (buffer == GL_NONE) return 0;
  GLenum attachment = GLenum(buffer);
  // The window system's buffers are asked for one by one, not by the names that mean several.
  if (buffer == GL_BACK || buffer == GL_FRONT_AND_BACK) attachment = GL_BACK_LEFT;
  if (buffer == GL_FRONT || buffer == GL_LEFT) attachment = GL_FRONT_LEFT;
  GLint type = GL_NONE;
  GLint bits = 0;
  gl.GetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, attachment, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE,
                                         &type);
  if (type == GL_NONE) return 0;
  gl.GetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, attachment, GL_FRAMEBUFFER_ATTACHMENT_ALPHA_SIZE,
                                         &bits);
  return bits;
}

std::optional<std::string> read_alpha_result(const DispatchTable& gl, Pipeline& pipeline) {
  const GLint source = integer(gl, GL_BLEND_SRC_ALPHA);
  const GLint destination = integer(gl, GL_BLEND_DST_ALPHA);
  std::array<GLboolean, 4> mask{};
  gl.GetBooleanv(GL_COLOR_WRITEMASK, mask.data());
  pipeline.alpha_bits = alpha_bits(gl);
  if (!mask[3] || (source == GL_ZERO && destination == GL_ONE) || pipeline.alpha_bits == 0) {
    pipeline.alpha = AlphaResult::untouched;
  } else if (destination == GL_ONE_MINUS_SRC_ALPHA && source == GL_ONE) {
    pipeline.alpha = AlphaResult::coverage;
  } else if (destination == GL_ONE_MINUS_SRC_ALPHA && source == GL_SRC_ALPHA) {
    pipeline.alpha = AlphaResult::squared_sum;
  } else {
    return "the blend function of alpha is not over";
  }
  return std::nullopt;
}

/// Queries in progress whose answer our own drawing would change.
std::optional<std::string> read_queries(const GlContext& context) {
  const DispatchTable& gl = *context.gl;
  const auto in_progress = [&](GLenum target) {
    GLint query = 0;
    gl.GetQueryiv(target, GL_CURRENT_QUERY, &query);
    return query != 0;
  };
  if (in_progress(GL_SAMPLES_PASSED) || (context.version >= 330 && in_progress(GL_ANY_SAMPLES_PASSED)) ||
      (context.version >= 430 && in_progress(GL_ANY_SAMPLES_PASSED_CONSERVATIVE))) {
    return "an occlusion query surrounds the slices";
  }
  if (context.version >= 300 &&
      (in_progress(GL_PRIMITIVES_GENERATED) || in_progress(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN))) {
    return "a query counts the primitives of the slices";
  }
  if (context.pipeline_statistics) {
    for (const GLenum target :
         {GL_VERTICES_SUBMITTED, GL_PRIMITIVES_SUBMITTED, GL_VERTEX_SHADER_INVOCATIONS,
          GL_FRAGMENT_SHADER_INVOCATIONS, GL_CLIPPING_INPUT_PRIMITIVES, GL_CLIPPING_OUTPUT_PRIMITIVES}) {
      if (in_progress(target)) return "a query counts what the slices' pipeline does";
    }
  }
  return std::nullopt;
}

/// What around the fragments keeps us from standing in.
std::optional<std::string> read_surroundings(const GlContext& context, Pipeline& pipeline) {
  const DispatchTable& gl = *context.gl;
  if (integer(gl, GL_BLEND_EQUATION_RGB) != GL_FUNC_ADD ||
      integer(gl, GL_BLEND_EQUATION_ALPHA) != GL_FUNC_ADD) {
    return "the blend equation is not addition";
  }
  const GLint source = integer(gl, GL_BLEND_SRC_RGB);
  const GLint destination = integer(gl, GL_BLEND_DST_RGB);
  if (destination != GL_ONE_MINUS_SRC_ALPHA || (source != GL_SRC_ALPHA && source != GL_ONE)) {
    return "the blend function is not over";
  }
  pipeline.premultiplied = source == GL_ONE;
  if (auto reason = read_alpha_result(gl, pipeline)) return reason;
  if (gl.IsEnabled(GL_STENCIL_TEST)) return "the stencil test is enabled";
  if (gl.IsEnabled(GL_COLOR_LOGIC_OP)) return "a logical operation is enabled";
  if (integer(gl, GL_SAMPLE_BUFFERS) > 0) return "the framebuffer is multisampled";
  if (context.version >= 300 && gl.IsEnabled(GL_FRAMEBUFFER_SRGB)) return "sRGB conversion is enabled";
  if (integer(gl, GL_DRAW_BUFFER1) != GL_NONE) return "more than one draw buffer";
  std::array<GLint, 2> mode{};
  gl.GetIntegerv(GL_POLYGON_MODE, mode.data());
  if (mode[0] != GL_FILL) return "polygons are not filled";
  pipeline.depth_test = gl.IsEnabled(GL_DEPTH_TEST);
  if (pipeline.depth_test) {
    const GLint compare = integer(gl, GL_DEPTH_FUNC);
    GLboolean write = GL_FALSE;
    gl.GetBooleanv(GL_DEPTH_WRITEMASK, &write);
    pipeline.depth_write = write;
    if (compare == GL_ALWAYS && !write) {
      pipeline.depth_test = false;
    } else if (compare != GL_LESS && compare != GL_LEQUAL) {
      return "the depth function is neither LESS nor LEQUAL";
    }
    pipeline.depth_or_equal = compare == GL_LEQUAL;
  }
  if (!context.core && integer(gl, GL_RENDER_MODE) != GL_RENDER)
    return "the application is in feedback or select mode";
  if (auto reason = read_queries(context)) return reason;
  if (context.version >= 400) {
    if (integer(gl, GL_TRANSFORM_FEEDBACK_BUFFER_ACTIVE) != 0) return "transform feedback is active";
  }
  return std::nullopt;
}

}  // namespace

PipelineFinding read_pipeline(const GlContext& context, const ShareGroup& group, ProgramSamplers& samplers) {
  const DispatchTable& gl = *context.gl;
  if (!gl.IsEnabled(GL_BLEND)) return NotAVolume{};
  Pipeline pipeline;
  pipeline.program = GLuint(integer(gl, GL_CURRENT_PROGRAM));
  std::optional<std::string> reason;
  if (pipeline.program != 0) {
    reason = read_program_textures(context, group, samplers, pipeline);
  } else if (!context.core) {
    reason = read_fixed_function_textures(context, pipeline);
  }
  if (pipeline.volume.texture == 0) return NotAVolume{};
  if (!reason) reason = read_surroundings(context, pipeline);
  if (reason) return LeftAlone{pipeline.volume.texture, *reason};
  return pipeline;
}

}  // namespace understudy::spu
