// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/pipeline/pipeline.h"

#include <algorithm>

#include "spu/state_value.h"
#include "spu/track/program_sources.h"
#include "spu/track/share_group.h"
#include "spu/volume/context/context.h"

namespace understudy::spu {
namespace {

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
  const GLint active = state_value(gl, GL_ACTIVE_TEXTURE);
  gl.ActiveTexture(GLenum(GL_TEXTURE0 + unit));
  const GLint texture = state_value(gl, binding_of(target));
  gl.ActiveTexture(GLenum(active));
  return GLuint(texture);
}

/// Returns the texture target of a sampler uniform's type; 0 for types that volume viewers do not use.
GLenum target_of_sampler(GLenum type) {
  switch (type) {
    case GL_SAMPLER_1D:
      return GL_TEXTURE_1D;
    case GL_SAMPLER_2D:
      return GL_TEXTURE_2D;
    case GL_SAMPLER_3D:
    case GL_INT_SAMPLER_3D:
    case GL_UNSIGNED_INT_SAMPLER_3D:
      return GL_TEXTURE_3D;
    case GL_SAMPLER_2D_RECT:
      return GL_TEXTURE_RECTANGLE;
    default:
      return 0;
  }
}

/// Chooses from the 2-D textures that a program samples the one on the active unit: an application that draws
/// slice after slice binds them there.
void take_slice(const DispatchTable& gl, Pipeline& pipeline) {
  const GLint active = state_value(gl, GL_ACTIVE_TEXTURE) - GL_TEXTURE0;
  const auto slice = std::ranges::find_if(pipeline.others, [&](const SampledTexture& sampled) {
    return sampled.target == GL_TEXTURE_2D && sampled.unit == active && sampled.texture != 0;
  });
  if (slice == pipeline.others.end()) return;
  pipeline.stack = true;
  pipeline.volume = *slice;
  pipeline.others.erase(slice);
}

/// Subroutine choices are lost when another program, and then this one, is used.
bool has_subroutines(const GlContext& context, GLuint program) {
  if (context.version < 400) return false;
  const auto count = [&](GLenum stage) {
    GLint uniforms = 0;
    context.gl->GetProgramStageiv(program, stage, GL_ACTIVE_SUBROUTINE_UNIFORMS, &uniforms);
    return uniforms;
  };
  return count(GL_FRAGMENT_SHADER) + count(GL_VERTEX_SHADER) > 0;
}

/// Finds the only 3-D texture and the tables that a program samples, or the slice of a stack. Returns a reason
/// if the program is not of this form.
std::optional<std::string> read_program_textures(const GlContext& context, const ShareGroup& group,
                                                 ProgramSamplers& samplers, bool stacks, Pipeline& pipeline) {
  const DispatchTable& gl = *context.gl;
  const std::shared_ptr<const ProgramRecord> record = group.programs().program(pipeline.program);
  if (record == nullptr) return std::nullopt;  // its link was not observed: no 3-D sampler is known
  int volumes = 0;
  bool integers = false;
  for (const SamplerUniform& sampler : samplers.of(gl, pipeline.program, record->link)) {
    const GLenum target = target_of_sampler(sampler.type);
    GLint unit = 0;
    gl.GetUniformiv(pipeline.program, sampler.location, &unit);
    if (target == 0) continue;
    SampledTexture sampled{target, unit, bound_texture(gl, target, unit), sampler.location};
    // A second sampler on the volume's unit reads the same texture. Viewers leave unused samplers on unit 0.
    if (target == GL_TEXTURE_3D && volumes > 0 && unit == pipeline.volume.unit) continue;
    // A 3-D sampler without a texture (a mask that is not in use) returns one value everywhere: PyMOL has one.
    if (target == GL_TEXTURE_3D && sampled.texture != 0) {
      ++volumes;
      pipeline.volume = sampled;
      integers |= sampler.type != GL_SAMPLER_3D;
    } else {
      pipeline.others.push_back(sampled);
    }
  }
  if (volumes > 1) return "the program samples more than one 3-D texture";
  if (integers) return "the program samples a 3-D texture of integers";
  if (pipeline.volume.texture != 0 && has_subroutines(context, pipeline.program))
    return "the program chooses its subroutines, which measuring it would forget";
  if (volumes == 0 && stacks) take_slice(gl, pipeline);
  if (pipeline.volume.texture != 0) {
    if (!record->fragment_source_known) return "the program's fragment shader source is not known";
    if (record->other_shader_stages) return "the program has geometry or tessellation stages";
    pipeline.vertex_shader = record->vertex_shader;
  }
  return std::nullopt;
}

/// Returns the text of the bound fragment assembly program.
std::string assembly_text(const DispatchTable& gl) {
  GLint length = 0;
  gl.GetProgramivARB(GL_FRAGMENT_PROGRAM_ARB, GL_PROGRAM_LENGTH_ARB, &length);
  if (length <= 0) return {};
  std::string text(std::size_t(length), ' ');
  gl.GetProgramStringARB(GL_FRAGMENT_PROGRAM_ARB, GL_PROGRAM_STRING_ARB, text.data());
  return text;
}

/// An assembly program may sample any texture that is bound.
std::optional<std::string> read_assembly_textures(const GlContext& context, Pipeline& pipeline) {
  const DispatchTable& gl = *context.gl;
  pipeline.assembly = assembly_text(gl);
  // There is only one spelling of the target.
  if (pipeline.assembly.find("3D") == std::string::npos) return std::nullopt;
  const GLint active = state_value(gl, GL_ACTIVE_TEXTURE);
  const GLint units = state_value(gl, GL_MAX_TEXTURE_IMAGE_UNITS);
  int volumes = 0;
  for (int unit = 0; unit < units; ++unit) {
    gl.ActiveTexture(GLenum(GL_TEXTURE0 + unit));
    for (const GLenum target : {GL_TEXTURE_1D, GL_TEXTURE_2D, GL_TEXTURE_RECTANGLE, GL_TEXTURE_3D}) {
      const auto texture = GLuint(state_value(gl, binding_of(target)));
      if (texture == 0) continue;
      if (target == GL_TEXTURE_3D) {
        ++volumes;
        pipeline.volume = {target, unit, texture, -1};
      } else {
        pipeline.others.push_back({target, unit, texture, -1});
      }
    }
  }
  gl.ActiveTexture(GLenum(active));
  if (volumes > 1) return "an assembly program runs while more than one 3-D texture is bound";
  return std::nullopt;
}

/// User clip planes clip the output of a vertex assembly program only if it requests that, which cannot be
/// queried.
std::optional<std::string> read_vertex_assembly(const GlContext& context) {
  const DispatchTable& gl = *context.gl;
  if (!context.vertex_assembly || !gl.IsEnabled(GL_VERTEX_PROGRAM_ARB)) return std::nullopt;
  const GLint planes = state_value(gl, GL_MAX_CLIP_PLANES);
  for (GLint i = 0; i < planes; ++i) {
    if (gl.IsEnabled(GLenum(GL_CLIP_PLANE0 + i))) return "clip planes cut what a vertex assembly program draws";
  }
  return std::nullopt;
}

/// Fog by the distance from the eye plane is an affine map of the position, like the camera; other fog is
/// refused.
std::optional<std::string> read_fog(const GlContext& context, Pipeline& pipeline) {
  const DispatchTable& gl = *context.gl;
  pipeline.fog = true;
  if (state_value(gl, GL_FOG_COORD_SRC) != GL_FRAGMENT_DEPTH)
    return "fog is enabled, by coordinates of the application's own";
  if (context.vertex_assembly && gl.IsEnabled(GL_VERTEX_PROGRAM_ARB))
    return "fog is enabled, by coordinates of a vertex assembly program";
  if (context.fog_distance && state_value(gl, GL_FOG_DISTANCE_MODE_NV) == GL_EYE_RADIAL_NV)
    return "fog is enabled, by the distance from the eye's point";
  return std::nullopt;
}

std::optional<std::string> read_fixed_function_textures(const GlContext& context, bool stacks,
                                                        Pipeline& pipeline) {
  const DispatchTable& gl = *context.gl;
  if (context.fragment_assembly && gl.IsEnabled(GL_FRAGMENT_PROGRAM_ARB)) {
    auto reason = read_assembly_textures(context, pipeline);
    if (!reason && pipeline.volume.texture != 0) reason = read_vertex_assembly(context);
    return reason;
  }
  const GLint active = state_value(gl, GL_ACTIVE_TEXTURE);
  int enabled_units = 0;
  for (int unit = 0; unit < context.fixed_function_units; ++unit) {
    gl.ActiveTexture(GLenum(GL_TEXTURE0 + unit));
    if (gl.IsEnabled(GL_TEXTURE_3D)) {
      pipeline.volume = {GL_TEXTURE_3D, unit, GLuint(state_value(gl, GL_TEXTURE_BINDING_3D)), -1};
      ++enabled_units;
    } else if (gl.IsEnabled(GL_TEXTURE_2D) || gl.IsEnabled(GL_TEXTURE_1D) ||
               gl.IsEnabled(GL_TEXTURE_CUBE_MAP)) {
      ++enabled_units;
    }
  }
  gl.ActiveTexture(GLenum(active));
  if (stacks && pipeline.volume.texture == 0 && enabled_units == 1) {
    const auto slice = GLuint(state_value(gl, GL_TEXTURE_BINDING_2D));
    if (active == GL_TEXTURE0 && slice != 0 && gl.IsEnabled(GL_TEXTURE_2D)) {
      pipeline.stack = true;
      pipeline.volume = {GL_TEXTURE_2D, 0, slice, -1};
    }
  }
  if (pipeline.volume.texture == 0) return std::nullopt;
  if (enabled_units > 1) return "more than one texture unit takes part in fixed function";
  if (pipeline.volume.unit != 0) return "the volume is not on texture unit 0 in fixed function";
  if (auto reason = read_vertex_assembly(context)) return reason;
  if (gl.IsEnabled(GL_FOG)) return read_fog(context, pipeline);
  return std::nullopt;
}

/// Returns the program pipeline object that draws while no program is in use; 0: none.
GLuint program_pipeline(const GlContext& context) {
  return context.program_pipelines ? GLuint(state_value(*context.gl, GL_PROGRAM_PIPELINE_BINDING)) : 0;
}

/// Finds the volume that the program pipeline `object` draws. Its stages are programs with uniforms of their
/// own, which may be exchanged one by one: always returns a reason.
std::optional<std::string> read_pipeline_textures(const GlContext& context, const ShareGroup& group,
                                                  ProgramSamplers& samplers, GLuint object,
                                                  Pipeline& pipeline) {
  GLint fragment_program = 0;
  context.gl->GetProgramPipelineiv(object, GL_FRAGMENT_SHADER, &fragment_program);
  pipeline.program = GLuint(fragment_program);
  constexpr bool stacks = false;
  if (pipeline.program != 0)
    read_program_textures(context, group, samplers, stacks, pipeline);
  else if (!context.core)
    read_fixed_function_textures(context, stacks, pipeline);
  return "a program pipeline object (glBindProgramPipeline) is drawn with";
}

/// Refuses queries in progress whose result our own drawing would change.
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

/// Within a slice all samples of a pixel get the colour at its centre, as in our image, unless samples are
/// shaded or masked individually.
std::optional<std::string> read_sample_operations(const GlContext& context, const Target& target) {
  const DispatchTable& gl = *context.gl;
  if (target.samples == 0 || !gl.IsEnabled(GL_MULTISAMPLE)) return std::nullopt;
  if (gl.IsEnabled(GL_SAMPLE_ALPHA_TO_COVERAGE) || gl.IsEnabled(GL_SAMPLE_ALPHA_TO_ONE))
    return "opacity becomes the coverage of a multisampled framebuffer";
  if (gl.IsEnabled(GL_SAMPLE_COVERAGE) || (context.version >= 320 && gl.IsEnabled(GL_SAMPLE_MASK)))
    return "only some samples of a multisampled framebuffer are drawn";
  if (context.version >= 400 && gl.IsEnabled(GL_SAMPLE_SHADING))
    return "the samples of a multisampled framebuffer are shaded one by one";
  return std::nullopt;
}

/// Refuses state of polygons that changes which pixels slices cover.
std::optional<std::string> read_rasterisation(const GlContext& context) {
  const DispatchTable& gl = *context.gl;
  std::array<GLint, 2> mode{};
  gl.GetIntegerv(GL_POLYGON_MODE, mode.data());
  if (mode[0] != GL_FILL || (!context.core && mode[1] != GL_FILL)) return "polygons are not filled";
  if (gl.IsEnabled(GL_RASTERIZER_DISCARD)) return "rasterisation is disabled";
  if (context.version >= 320 && gl.IsEnabled(GL_DEPTH_CLAMP))
    return "depth clamping shows what the view volume would cut off";
  if (gl.IsEnabled(GL_POLYGON_SMOOTH)) return "polygons are smoothed";
  if (!context.core && gl.IsEnabled(GL_POLYGON_STIPPLE)) return "polygons are stippled";
  if (context.version >= 450 && (state_value(gl, GL_CLIP_ORIGIN) != GL_LOWER_LEFT ||
                                 state_value(gl, GL_CLIP_DEPTH_MODE) != GL_NEGATIVE_ONE_TO_ONE)) {
    return "clip control turns or moves the view volume";
  }
  return std::nullopt;
}

/// Whether the application's framebuffer has depths. If not, all fragments pass the depth test (OpenGL 4.6,
/// 17.3.4), and depths cannot be read.
bool has_depth_buffer(const DispatchTable& gl) {
  if (gl.GetFramebufferAttachmentParameteriv == nullptr) return true;
  const bool window = state_value(gl, GL_DRAW_FRAMEBUFFER_BINDING) == 0;
  GLint type = GL_NONE;
  gl.GetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, window ? GL_DEPTH : GL_DEPTH_ATTACHMENT,
                                         GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, &type);
  return type != GL_NONE;
}

/// Whether polygons are tested at other depths than their vertices have.
bool offsets_depths(const DispatchTable& gl) {
  GLfloat factor = 0;
  GLfloat units = 0;
  gl.GetFloatv(GL_POLYGON_OFFSET_FACTOR, &factor);
  gl.GetFloatv(GL_POLYGON_OFFSET_UNITS, &units);
  return gl.IsEnabled(GL_POLYGON_OFFSET_FILL) && (factor != 0 || units != 0);
}

std::optional<std::string> read_depth_test(const DispatchTable& gl, Pipeline& pipeline) {
  pipeline.depth_test = gl.IsEnabled(GL_DEPTH_TEST) && has_depth_buffer(gl);
  if (!pipeline.depth_test) return std::nullopt;
  const GLint compare = state_value(gl, GL_DEPTH_FUNC);
  GLboolean write = GL_FALSE;
  gl.GetBooleanv(GL_DEPTH_WRITEMASK, &write);
  pipeline.depth_write = write;
  if (compare == GL_ALWAYS && !write) {
    pipeline.depth_test = false;
  } else if (compare != GL_LESS && compare != GL_LEQUAL) {
    return "the depth function is neither LESS nor LEQUAL";
  }
  pipeline.depth_or_equal = compare == GL_LEQUAL;
  if ((pipeline.depth_test || pipeline.depth_write) && offsets_depths(gl))
    return "a polygon offset moves the depths of what is drawn";
  if (pipeline.depth_write && pipeline.blending.front_to_back != FrontToBack::no)
    return "slices drawn front to back write depth, and so hide each other";
  return std::nullopt;
}

/// Refuses state around the fragments with which they cannot be substituted.
std::optional<std::string> read_surroundings(const GlContext& context, Pipeline& pipeline) {
  const DispatchTable& gl = *context.gl;
  pipeline.target = read_target(gl);
  if (!pipeline.target.normalised && !pipeline.target.floating)
    return "the framebuffer's colours are neither normalised nor float";
  if (auto reason = read_blending(gl, pipeline.target, pipeline.blending)) return reason;
  if (pipeline.blending.replaces && !context.core && gl.IsEnabled(GL_ALPHA_TEST))
    return "fragments that the alpha test takes away replace nothing";
  if (gl.IsEnabled(GL_STENCIL_TEST)) return "the stencil test is enabled";
  if (gl.IsEnabled(GL_COLOR_LOGIC_OP)) return "a logical operation is enabled";
  if (auto reason = read_sample_operations(context, pipeline.target)) return reason;
  const GLint draw_buffers = state_value(gl, GL_MAX_DRAW_BUFFERS);
  for (GLint i = 1; i < draw_buffers; ++i) {
    if (state_value(gl, GLenum(GL_DRAW_BUFFER0 + i)) != GL_NONE) return "more than one draw buffer";
  }
  if (auto reason = read_rasterisation(context)) return reason;
  if (auto reason = read_depth_test(gl, pipeline)) return reason;
  if (!context.core && state_value(gl, GL_RENDER_MODE) != GL_RENDER)
    return "the application is in feedback or select mode";
  if (auto reason = read_queries(context)) return reason;
  if (context.version >= 400) {
    if (state_value(gl, GL_TRANSFORM_FEEDBACK_BUFFER_ACTIVE) != 0) return "transform feedback is active";
  }
  return std::nullopt;
}

}  // namespace

PipelineFinding read_pipeline(const GlContext& context, const ShareGroup& group, ProgramSamplers& samplers,
                              bool stacks) {
  const DispatchTable& gl = *context.gl;
  Pipeline pipeline;
  pipeline.program = GLuint(state_value(gl, GL_CURRENT_PROGRAM));
  std::optional<std::string> reason;
  if (pipeline.program != 0) {
    reason = read_program_textures(context, group, samplers, stacks, pipeline);
  } else if (const GLuint object = program_pipeline(context); object != 0) {
    reason = read_pipeline_textures(context, group, samplers, object, pipeline);
  } else if (!context.core) {
    reason = read_fixed_function_textures(context, stacks, pipeline);
  }
  if (pipeline.volume.texture == 0) return NotAVolume{};
  // A fragment can be a whole ray only if a program computes it.
  const bool may_be_rays = pipeline.program != 0 && !pipeline.stack;
  if (!may_be_rays && !gl.IsEnabled(GL_BLEND)) reason = slices_replace;
  if (!reason) reason = read_surroundings(context, pipeline);
  if (!reason && !may_be_rays && pipeline.blending.replaces) reason = slices_replace;
  // One textured quad does not indicate a volume: nothing is reported.
  if (reason && pipeline.stack) return NotAVolume{};
  if (reason) return LeftAlone{pipeline.volume.texture, *reason};
  return pipeline;
}

}  // namespace understudy::spu
