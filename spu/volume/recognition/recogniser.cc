// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/recognition/recogniser.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "spu/track/program_sources.h"
#include "spu/track/share_group.h"
#include "spu/volume/context/context.h"
#include "spu/volume/geometry/feedback.h"
#include "spu/volume/proxy/coordinate_space.h"
#include "volume/matrix.h"

namespace understudy::spu {
namespace {

volume::Matrix4 projection_matrix(const DispatchTable& gl) {
  std::array<GLdouble, 16> column_major{};
  gl.GetDoublev(GL_PROJECTION_MATRIX, column_major.data());
  volume::Matrix4 matrix{};
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 4; ++column)
      matrix[4 * row + column] = column_major[4 * column + row];
  }
  return matrix;
}

/// Returns the row vector `plane` times `matrix`: plane equations are transformed inversely to points.
std::array<double, 4> plane_times(const std::array<double, 4>& plane, const volume::Matrix4& matrix) {
  std::array<double, 4> result{};
  for (std::size_t column = 0; column < 4; ++column) {
    for (std::size_t row = 0; row < 4; ++row) result[column] += plane[row] * matrix[4 * row + column];
  }
  return result;
}

/// Transforms the application's user clip planes, which OpenGL keeps in eye space, to texture space through the
/// camera.
std::vector<volume::HalfSpace> clip_planes_in_texture_space(const DispatchTable& gl,
                                                            const volume::Matrix4& texture_to_clip) {
  std::vector<volume::HalfSpace> planes;
  GLint count = 0;
  gl.GetIntegerv(GL_MAX_CLIP_PLANES, &count);
  std::optional<volume::Matrix4> clip_to_eye;
  for (GLint i = 0; i < count; ++i) {
    if (!gl.IsEnabled(GLenum(GL_CLIP_PLANE0 + i))) continue;
    if (!clip_to_eye) clip_to_eye = volume::inverse(projection_matrix(gl));
    if (!clip_to_eye) throw Refusal{"the projection matrix is singular"};
    std::array<double, 4> eye{};
    gl.GetClipPlane(GLenum(GL_CLIP_PLANE0 + i), eye.data());
    const auto texture = plane_times(plane_times(eye, *clip_to_eye), texture_to_clip);
    planes.push_back({{texture[0], texture[1], texture[2]}, texture[3]});
  }
  return planes;
}

bool clips_in_shader(const DispatchTable& gl) {
  GLint count = 0;
  gl.GetIntegerv(GL_MAX_CLIP_DISTANCES, &count);
  for (GLint i = 0; i < count; ++i) {
    if (gl.IsEnabled(GLenum(GL_CLIP_DISTANCE0 + i))) return true;
  }
  return false;
}

/// Returns the distances of vertices from the plane through the eye, which fixed-function fog depends on.
std::vector<float> eye_distances(const DispatchTable& gl, std::span<const ObservedVertex> vertices) {
  const auto clip_to_eye = volume::inverse(projection_matrix(gl));
  if (!clip_to_eye) throw Refusal{"the projection matrix is singular"};
  std::vector<float> distances;
  for (const ObservedVertex& vertex : vertices) {
    const volume::Vec4 eye = volume::transform(*clip_to_eye, vertex.clip);
    distances.push_back(float(std::abs(eye[2] / eye[3])));
  }
  return distances;
}

/// Gives the captured slices of a stack their third coordinate. The end whose texture has the lower name is the
/// low end, from whichever side the stack is drawn.
std::vector<GLuint> place_slices(const Run& run, ObservedPolygons& polygons) {
  std::vector<GLuint> textures = run.slices();
  const bool downwards = textures.front() > textures.back();
  const auto n = double(textures.size());
  for (ObservedVertex& vertex : polygons.vertices) {
    const double place = (vertex.texture[2] + 0.5) / n;
    vertex.texture[2] = downwards ? 1 - place : place;
  }
  if (downwards) std::reverse(textures.begin(), textures.end());
  return textures;
}

/// A ray caster's box is one draw, or one draw for each of its faces.
bool may_be_box(const Run& run, const ProgramStages& stages) {
  constexpr std::size_t faces = 6;
  return run.draws <= faces && stages.observer != 0;
}

/// Whether front and back faces have colours of their own, of which only the front's are captured.
bool may_show_back_colours(const GlContext& context, const ProgramStages& stages) {
  if (context.core || !context.gl->IsEnabled(GL_VERTEX_PROGRAM_TWO_SIDE)) return false;
  return std::ranges::any_of(stages.inputs, [](const StageInput& input) {
    return input.name == "gl_FrontColor" || input.name == "gl_FrontSecondaryColor";
  });
}

/// Whether face culling removes any of the triangles, which transform feedback captures all the same.
bool culls_any(const DispatchTable& gl, const ObservedPolygons& triangles) {
  if (!gl.IsEnabled(GL_CULL_FACE)) return false;
  GLint culled = GL_BACK;
  GLint front = GL_CCW;
  gl.GetIntegerv(GL_CULL_FACE_MODE, &culled);
  gl.GetIntegerv(GL_FRONT_FACE, &front);
  if (culled == GL_FRONT_AND_BACK) return true;
  for (std::size_t p = 0; p < triangles.count(); ++p) {
    const auto corner = triangles.polygon(p);
    const auto& a = corner[0].clip;
    const auto& b = corner[1].clip;
    const auto& c = corner[2].clip;
    // The sign of the area in the window, also where corners lie behind the eye; rounding has none.
    constexpr double rounding = 1e-6;
    const std::array terms{a[0] * (b[1] * c[3] - c[1] * b[3]), -b[0] * (a[1] * c[3] - c[1] * a[3]),
                           c[0] * (a[1] * b[3] - b[1] * a[3])};
    const double area = terms[0] + terms[1] + terms[2];
    if (std::abs(area) <= rounding * (std::abs(terms[0]) + std::abs(terms[1]) + std::abs(terms[2]))) continue;
    const bool is_front = (area > 0) == (front == GL_CCW);
    if (is_front == (culled == GL_FRONT)) return true;
  }
  return false;
}

Refusal not_affine(const char* reason, const CameraFit& fit) {
  return {reason, fmt::format("residual {:.2g} of a fit, {:.0e} is allowed", fit.residual, max_fit_residual)};
}

/// Takes the inputs of fragments from feedback, which reports no others.
void take_inputs_of_feedback(const Pipeline& pipeline, RecognisedRun& seen) {
  FragmentInputs& fragment = seen.fragment;
  fragment.coordinate = "gl_TexCoord[0]";
  for (const StageInput& input : fragment.inputs) {
    if (input.name == "gl_TexCoord[0]") {
      fragment.first.push_back({});
    } else if (input.name == "gl_FrontColor") {
      fragment.first.push_back(*seen.polygons.constant_colour);
    } else if (pipeline.fog && input.name == "gl_FogFragCoord") {
      fragment.first.push_back({seen.fog_numbers.front(), 0, 0, 0});
    } else {
      throw Refusal{"the fragment shader reads " + input.name + ", which feedback does not tell"};
    }
  }
  fragment.last = fragment.first;
  fragment.range = {fragment.first, fragment.first};
  if (!pipeline.fog) return;
  const auto [low, high] = std::minmax_element(seen.fog_numbers.begin(), seen.fog_numbers.end());
  fragment.first.back()[0] = fragment.range.low.back()[0] = *low;
  fragment.last.back()[0] = fragment.range.high.back()[0] = *high;
}

}  // namespace

SliceOrder order_of(const Pipeline& pipeline) {
  if (pipeline.blending.front_to_back != FrontToBack::no) return SliceOrder::front_to_back;
  // Slices that write depth hide later ones behind them.
  const bool matters =
      pipeline.blending.op == volume::Operator::over || pipeline.blending.alpha.op == volume::Operator::over;
  return matters || (pipeline.depth_test && pipeline.depth_write) ? SliceOrder::back_to_front : SliceOrder::any;
}

RecognisedRun Recogniser::find_geometry(const Run& run, const std::string& known_coordinate) {
  RecognisedRun seen = observe(run, known_coordinate);
  if (!seen.ray_caster) find_slices_of(run.pipeline(), seen);
  return seen;
}

RecognisedRun Recogniser::recognise(const Run& run, const std::string& known_coordinate) {
  RecognisedRun seen = find_geometry(run, known_coordinate);
  seen.texture_version = texture_version(run.pipeline(), seen);
  return seen;
}

RecognisedRun Recogniser::observe(const Run& run, const std::string& known_coordinate) {
  const Pipeline& pipeline = run.pipeline();
  RecognisedRun seen;
  if (pipeline.program != 0) seen.fragment.record = group_.programs().program(pipeline.program);
  const ProgramRecord* const record = seen.fragment.record.get();
  seen.fragment.application = pipeline.program;
  if (record != nullptr) {
    const ProgramStages& parts = programs_.stages(pipeline.program, *record);
    seen.fragment.inputs = parts.inputs;
    if (pipeline.blending.replaces && !(record->vertex_shader && may_be_box(run, parts)))
      throw Refusal{slices_replace};
    if (!parts.trouble.empty() && !may_be_box(run, parts)) throw Refusal{parts.trouble};
    if (record->vertex_shader) {
      observe_shader(run, parts, known_coordinate, seen);
      return seen;
    }
  } else {
    seen.fragment.inputs = {{"gl_TexCoord[0]", GL_FLOAT_VEC4, 4, false},
                            {"gl_FrontColor", GL_FLOAT_VEC4, 4, false}};
  }
  observe_fixed_function(run, seen);
  return seen;
}

void Recogniser::observe_shader(const Run& run, const ProgramStages& stages,
                                const std::string& known_coordinate, RecognisedRun& seen) {
  if (!stages.written_by_vertices.empty())
    throw Refusal{"the vertex shader writes to '" + stages.written_by_vertices + "'"};
  if (clips_in_shader(*context_.gl)) throw Refusal{"clip planes cut what a vertex shader draws"};
  if (may_show_back_colours(context_, stages))
    throw Refusal{"a vertex shader gives front and back faces colours of their own"};
  Capture capture = capture_vertices(context_, run, stages, known_coordinate);
  if (!capture.fit && !known_coordinate.empty()) capture = capture_vertices(context_, run, stages);
  if (capture.polygons.count() == 0) throw NothingVisible{};
  seen.ray_caster = may_be_box(run, stages) && capture.fit && draws_box(context_, run, stages, capture);
  if (seen.ray_caster) {
    seen.capture = std::move(capture);
    return;
  }
  if (run.pipeline().blending.replaces) throw Refusal{slices_replace};
  if (!stages.trouble.empty()) throw Refusal{stages.trouble};
  if (culls_any(*context_.gl, capture.polygons)) throw Refusal{"faces of slices are culled"};
  if (!capture.fit && capture.polygons.count() == 1)
    throw Refusal{"a single slice does not determine the camera"};
  if (!capture.fit) throw Refusal{"no output of the vertex shader is an affine map of the position"};
  seen.polygons = std::move(capture.polygons);
  seen.fit = capture.fit;
  if (run.pipeline().stack) {
    seen.stack = place_slices(run, seen.polygons);
    seen.fit = fit_camera(seen.polygons.vertices);
  }
  seen.fragment.coordinate = capture.coordinate;
  seen.fragment.first = capture.first;
  seen.fragment.last = capture.last;
  seen.fragment.range = capture.range;
  seen.capture = std::move(capture);
}

void Recogniser::observe_fixed_function(const Run& run, RecognisedRun& seen) {
  const DispatchTable& gl = *context_.gl;
  const Pipeline& pipeline = run.pipeline();
  if (gl.IsEnabled(GL_COLOR_SUM)) throw Refusal{"a secondary colour is added after texturing"};
  GLint colour_control = 0;
  gl.GetIntegerv(GL_LIGHT_MODEL_COLOR_CONTROL, &colour_control);
  if (gl.IsEnabled(GL_LIGHTING) && colour_control == GL_SEPARATE_SPECULAR_COLOR) {
    throw Refusal{"specular colour is added after texturing"};
  }
  seen.polygons = observe_by_feedback(context_, run, given_);
  if (seen.polygons.count() == 0) throw NothingVisible{};
  if (pipeline.stack) seen.stack = place_slices(run, seen.polygons);
  if (pipeline.fog) {
    seen.fog_numbers = eye_distances(gl, seen.polygons.vertices);
    seen.fragment.inputs.push_back({"gl_FogFragCoord", GL_FLOAT, 1, false});
  }
  if (!seen.polygons.constant_colour)
    throw Refusal{"the colour varies over the slices (lighting with a varying normal)"};
  take_inputs_of_feedback(pipeline, seen);
}

void Recogniser::find_slices_of(const Pipeline& pipeline, RecognisedRun& seen) {
  if (!seen.fit) seen.fit = fit_camera(seen.polygons.vertices);
  if (!seen.fit) throw Refusal{"the draw does not span the volume (a single slice or face)"};
  if (seen.fit->residual > max_fit_residual)
    throw not_affine("positions are not an affine map of texture coordinates", *seen.fit);
  if (seen.polygons.clipped) {
    seen.clip_planes = clip_planes_in_texture_space(*context_.gl, seen.fit->texture_to_clip);
  }
  SliceFinding finding = find_slices(seen.polygons, *seen.fit, seen.clip_planes, order_of(pipeline));
  if (const auto* refusal = std::get_if<Refusal>(&finding)) throw *refusal;
  seen.slices = std::get<SliceSet>(finding);
  if (!seen.capture || pipeline.stack) return;
  seen.slice_segments =
      find_slice_segments(*seen.capture, seen.polygons.vertices, seen.fragment.inputs, seen.slices, *seen.fit);
  for (const ObservedSegment& observed : seen.slice_segments)
    seen.fragment.segment_ends.push_back(observed.input);
}

std::uint64_t Recogniser::texture_version(const Pipeline& pipeline, const RecognisedRun& seen) const {
  std::uint64_t version = group_.texture_version(pipeline.volume.texture);
  for (const GLuint texture : seen.stack) {
    if (group_.is_rendered_to(texture)) throw Refusal{"a texture of the stack is rendered into"};
    // The mixture differs for any two stacks, and for any two states of one.
    constexpr std::uint64_t prime = 0x100000001b3;
    version = (version * prime) ^ texture;
    version = (version * prime) ^ group_.texture_version(texture);
  }
  return version;
}

}  // namespace understudy::spu
