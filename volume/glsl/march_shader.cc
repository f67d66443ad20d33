// SPDX-License-Identifier: Apache-2.0
#include "volume/glsl/march_shader.h"

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace understudy::volume::glsl {

namespace {

// One triangle that covers all pixels.
constexpr const char* vertex_source = R"(#version 330 core
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }
)";

// Blocks are looked up and termination is tested once per eight samples, with branch-free code in between.
// Samples in blocks that show nothing add nothing, so it is harmless if some of the eight lie there.
constexpr const char* fragment_source = R"(
uniform sampler2D ray_starts;   // lattice position of sample 0, and the ray's first sample
uniform sampler2D ray_steps;    // from sample to sample, and the ray's last sample
#ifdef WHOLE_RAYS
uniform sampler2D ray_ends;     // of what the last sample stands for, in steps
#endif
uniform sampler3D field;        // a texel per lattice point
uniform usampler3D distances;   // per block, see OccupancyMap
uniform vec3 texture_origin, texture_scale;
uniform ivec3 first_block;
uniform vec3 top, rounding;
uniform vec3 has_border;
uniform vec4 border;
uniform float termination;
uniform float opacity_limit;
#ifdef COLOURS
uniform mat4 map;
uniform float multiply_by_alpha, alpha_above;
#else
uniform sampler1D table;
uniform float table_low, table_scale, table_last;
#endif

#ifdef BRICKED
uniform usampler3D pages;      // per brick its slot along each axis, and whether it is there
uniform sampler2D sums;        // what the passes before composed
uniform sampler2D progress;    // what they left in `walked`
uniform float brick_cells;     // a power of two
uniform int passes_before;
#endif

layout(location = 0) out vec4 pixel;
#ifdef BRICKED
// Next sample; those taken, as below; the brick waited for, counted from 1; those left behind what is opaque.
layout(location = 1) out vec4 walked;
#else
layout(location = 1) out vec2 taken;  // samples, negative when the ray became opaque; those left behind it
#endif

vec3 start, step_;
float last;  // sample
#ifdef WHOLE_RAYS
float last_length;
#endif
#if !defined(NEAREST) && !defined(OWN_FILTER) && !defined(BRICKED)
vec3 start_in_texture, step_in_texture;
#endif
#if !defined(COLOURS) && !defined(OWN_FILTER)
float table_step, table_begin;  // in the table's texture: from one value to the next, and its first entry
#endif

#ifdef BRICKED
ivec3 brick;           // the one that is sampled
vec3 first_of_brick;   // lattice position of its first texel
vec3 in_atlas;         // where in the atlas that is

ivec3 brick_at(float k) {
  // A driver may fuse the product and the sum, and a ray's last sample lie on the face of what is held.
  ivec3 brick = ivec3((clamp(k * step_ + start, vec3(0.0), top) - texture_origin) / brick_cells);
  return clamp(brick, ivec3(0), textureSize(pages, 0) - 1);
}
// The first difference is exact, so that what is rounded down is what would be without bricks.
#define TEXEL_AT(position) (ivec3((position) - first_of_brick) + ivec3(in_atlas))
#define LAST_CORNER ivec3(2147483646)
#else
#define TEXEL_AT(position) ivec3((position) - texture_origin)
#define LAST_CORNER (textureSize(field, 0) - 2)
#endif

#ifdef OWN_FILTER
TEXEL at_corner(ivec3 corner) { return texelFetch(field, corner, 0).SWIZZLE; }

TEXEL interpolated(vec3 free) {
  vec3 p = clamp(free, vec3(0.0), top);
  vec3 cell = floor(p);
  vec3 share = p - cell;
  ivec3 a = clamp(TEXEL_AT(cell), ivec3(0), LAST_CORNER), b = a + 1;
  TEXEL front = mix(mix(at_corner(a), at_corner(ivec3(b.x, a.yz)), share.x),
                    mix(at_corner(ivec3(a.x, b.y, a.z)), at_corner(ivec3(b.xy, a.z)), share.x), share.y);
  TEXEL back = mix(mix(at_corner(ivec3(a.xy, b.z)), at_corner(ivec3(b.x, a.y, b.z)), share.x),
                   mix(at_corner(ivec3(a.x, b.yz)), at_corner(b), share.x), share.y);
  return mix(front, back, share.z);
}
#endif

TEXEL sample_field(float k) {
#if defined(NEAREST) || defined(BORDERED) || defined(OWN_FILTER) || defined(BRICKED)
  vec3 free = k * step_ + start;
#endif
#ifdef NEAREST
  vec3 p = clamp(free, vec3(0.0), top);
  return texelFetch(field, TEXEL_AT(p + 0.5), 0).SWIZZLE;
#else
#ifdef OWN_FILTER
  TEXEL inside = interpolated(free);
#elif defined(BRICKED)
  // Beyond a brick's outermost texels lie those of another.
  TEXEL inside = textureLod(field, (clamp(free, vec3(0.0), top) - first_of_brick + in_atlas + 0.5) * texture_scale, 0.0).SWIZZLE;
#else
  // Beyond its outermost texels the texture repeats them, as the lattice does.
  TEXEL inside = textureLod(field, k * step_in_texture + start_in_texture, 0.0).SWIZZLE;
#endif
#ifdef BORDERED
  vec3 beyond = abs(free - clamp(free, vec3(0.0), top)) * has_border;
  vec3 weight = max(1.0 - beyond, 0.0);
  return mix(border.SWIZZLE, inside, weight.x * weight.y * weight.z);
#else
  return inside;
#endif
#endif
}

vec4 classified(TEXEL value) {
#ifdef COLOURS
  vec4 colour = clamp(map * value, 0.0, 1.0);
  if (colour.a <= alpha_above) return vec4(NEUTRAL);
  colour.rgb *= mix(1.0, colour.a, multiply_by_alpha);
  return colour;
#else
#ifdef OWN_FILTER
  float place = clamp((value - table_low) * table_scale, 0.0, table_last);
  int entry = min(int(place), int(table_last) - 1);
  return mix(texelFetch(table, entry, 0), texelFetch(table, entry + 1, 0), place - float(entry));
#else
  // Beyond its ends the texture repeats them.
  return textureLod(table, (value - table_low) * table_step + table_begin, 0.0);
#endif
#endif
}

#ifdef WHOLE_RAYS
// From what a layer one step long shows to what one of `length_` steps does. Series where 1 - alpha would round.
vec4 resized_layer(vec4 colour, float length_) {
  if (colour.a <= 0.0) return colour * length_;
  if (colour.a >= 1.0) return colour;
  float a = colour.a;
  float depth = length_ * (a < 1e-3 ? a * (1.0 + a * (0.5 + a / 3.0)) : -log(1.0 - a));
  float kept = depth < 1e-3 ? depth * (1.0 - depth * (0.5 - depth / 6.0)) : 1.0 - exp(-depth);
  return colour * (kept / a);
}
#endif

vec4 colour_at(float k, TEXEL value) {
  vec4 colour = classified(value);
#ifdef WHOLE_RAYS
  if (k == last) colour = resized_layer(colour, last_length);
#endif
  if (k > last) colour = vec4(NEUTRAL);
  return colour;
}

void main() {
  vec4 from = texelFetch(ray_starts, ivec2(gl_FragCoord.xy), 0);
  vec4 along = texelFetch(ray_steps, ivec2(gl_FragCoord.xy), 0);
  start = from.xyz;
  step_ = along.xyz;
  float k = from.w;
  last = along.w;
#ifdef WHOLE_RAYS
  last_length = texelFetch(ray_ends, ivec2(gl_FragCoord.xy), 0).r;
#endif
#if !defined(NEAREST) && !defined(OWN_FILTER) && !defined(BRICKED)
  start_in_texture = (start - texture_origin + 0.5) * texture_scale;
  step_in_texture = step_ * texture_scale;
#endif
#if !defined(COLOURS) && !defined(OWN_FILTER)
  table_step = table_scale / (table_last + 1.0);
  table_begin = 0.5 / (table_last + 1.0);
#endif
  vec3 speed = max(abs(step_), vec3(1e-20));
  vec4 sum = vec4(NEUTRAL);
  float count = 0.0, hidden = 0.0;
#ifdef BRICKED
  float awaited = 0.0;
  if (passes_before > 0) {
    vec4 before = texelFetch(progress, ivec2(gl_FragCoord.xy), 0);
    sum = texelFetch(sums, ivec2(gl_FragCoord.xy), 0);
    k = before.x;
    count = before.y;
    hidden = before.w;
  }
#endif
  while (k <= last) {
    // First all rays of a group skip, then all take samples: what one does, the others wait for.
    for (;;) {
      vec3 p = clamp(k * step_ + start, vec3(0.0), top);
      vec3 block = floor(p * 0.125);
      float away = float(texelFetch(distances, ivec3(block) - first_block, 0).r);
      if (away == 0.0) break;
      // All blocks fewer than `away` steps away show nothing; rounding must not carry us past their faces.
      vec3 inside = p - 8.0 * block;
      vec3 room = mix(inside + 8.0 * (away - 1.0), 8.0 * away - inside, greaterThan(step_, vec3(0.0)));
      vec3 steps = (room - rounding) / speed * (1.0 - 1e-6);
      k += floor(max(min(min(steps.x, steps.y), steps.z), 0.0)) + 1.0;
      if (k > last) break;
    }
    if (k > last) break;
    float many = 8.0;
#ifdef BRICKED
    brick = brick_at(k);
    uvec4 page = texelFetch(pages, brick, 0);
    if (page.a == 0u) {
      ivec3 counts = textureSize(pages, 0);
      awaited = float((brick.z * counts.y + brick.y) * counts.x + brick.x) + 1.0;
      break;
    }
    first_of_brick = vec3(brick) * brick_cells + texture_origin;
    in_atlas = vec3(page.rgb) * (brick_cells + 1.0);
    for (int i = 0; i < 8; ++i) {
      float here = k + float(i);
      if (brick_at(min(here, last)) != brick) {
        many = float(i);
        break;
      }
      vec4 colour = colour_at(here, sample_field(min(here, last)));
      COMPOSE(colour)
    }
#else
    // All four values, then all four colours: a software rasteriser's code keeps this order, in which none waits
    // for the one before.
    for (int i = 0; i < 8; i += 4) {
      float k0 = k + float(i), k1 = k0 + 1.0, k2 = k0 + 2.0, k3 = k0 + 3.0;
      TEXEL value0 = sample_field(min(k0, last)), value1 = sample_field(min(k1, last));
      TEXEL value2 = sample_field(min(k2, last)), value3 = sample_field(min(k3, last));
      vec4 colour0 = colour_at(k0, value0), colour1 = colour_at(k1, value1);
      vec4 colour2 = colour_at(k2, value2), colour3 = colour_at(k3, value3);
      COMPOSE(colour0)
      COMPOSE(colour1)
      COMPOSE(colour2)
      COMPOSE(colour3)
    }
#endif
    count += min(many, last - k + 1.0);
    k += many;
#ifdef ENDS
    if (ENDS) {
      hidden = max(last - k + 1.0, 0.0);
      count = -count;
      k = last + 1.0;
      break;
    }
#endif
  }
  pixel = sum;
#ifdef BRICKED
  walked = vec4(k, count, awaited, hidden);
#else
  taken = vec2(count, hidden);
#endif
}
)";

const char* composition(Operator op) {
  switch (op) {
    case Operator::over:
      return "if (sum.a < opacity_limit || opacity_limit == 1.0) sum += (1.0 - sum.a) * colour;";
    case Operator::add:
      return "sum += colour;";
    case Operator::max:
      return "sum = max(sum, colour);";
    case Operator::min:
      return "sum = min(sum, colour);";
    case Operator::first_hit:
      return "if (sum.a == 0.0 && colour.a > 0.0) sum = vec4(clamp(colour.rgb / colour.a, -3e38, 3e38), 1.0);";
  }
  return "";
}

std::string defines(const MarchVariant& variant) {
  std::string text = "#version 330 core\n";
  const auto define = [&](bool when, const char* what) {
    if (when) text += fmt::format("#define {}\n", what);
  };
  define(variant.colours, "COLOURS");
  define(variant.colours, "TEXEL vec4");
  define(variant.colours, "SWIZZLE rgba");
  define(!variant.colours, "TEXEL float");
  define(!variant.colours, "SWIZZLE r");
  define(variant.bordered, "BORDERED");
  define(variant.filter == Filter::nearest, "NEAREST");
  define(variant.op == Operator::over, "ENDS 1.0 - sum.a < termination");
  define(variant.op == Operator::first_hit, "ENDS sum.a > 0.0");
  define(variant.own_filter, "OWN_FILTER");
  define(variant.bricked, "BRICKED");
  define(variant.whole_rays, "WHOLE_RAYS");
  // The largest float, without a literal that some compilers round up to infinity.
  define(variant.op == Operator::min, "NEUTRAL uintBitsToFloat(0x7f7fffffu)");
  define(variant.op != Operator::min, "NEUTRAL 0.0");
  return text + fmt::format("#define COMPOSE(colour) {}\n", composition(variant.op));
}

/// A shader or program that is deleted when linking ends, also by an exception.
class Shader {
 public:
  Shader(const Functions& gl, GLenum stage, const std::string& source)
      : gl_(gl), name_(gl.CreateShader(stage)) {
    const char* text = source.c_str();
    gl.ShaderSource(name_, 1, &text, nullptr);
    gl.CompileShader(name_);
  }
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
  ~Shader() { gl_.DeleteShader(name_); }
  GLuint name() const { return name_; }

 private:
  const Functions& gl_;
  GLuint name_;
};

}  // namespace

MarchProgram link_march_program(const Functions& gl, const MarchVariant& variant) {
  const Shader vertex(gl, GL_VERTEX_SHADER, vertex_source);
  const Shader fragment(gl, GL_FRAGMENT_SHADER, defines(variant) + fragment_source);
  MarchProgram program;
  program.name = gl.CreateProgram();
  gl.AttachShader(program.name, vertex.name());
  gl.AttachShader(program.name, fragment.name());
  gl.LinkProgram(program.name);
  GLint linked = 0;
  gl.GetProgramiv(program.name, GL_LINK_STATUS, &linked);
  if (linked == 0) {
    std::string words(1024, '\0');
    GLsizei length = 0;
    gl.GetProgramInfoLog(program.name, GLsizei(words.size()), &length, words.data());
    words.resize(std::size_t(length));
    gl.DeleteProgram(program.name);
    throw std::runtime_error(fmt::format("OpenGL refuses the ray caster's shader: {}", words));
  }
  const auto at = [&](const char* name) { return gl.GetUniformLocation(program.name, name); };
  program.texture_origin = at("texture_origin");
  program.texture_scale = at("texture_scale");
  program.first_block = at("first_block");
  program.top = at("top");
  program.rounding = at("rounding");
  program.has_border = at("has_border");
  program.border = at("border");
  program.table_low = at("table_low");
  program.table_scale = at("table_scale");
  program.table_last = at("table_last");
  program.map = at("map");
  program.multiply_by_alpha = at("multiply_by_alpha");
  program.alpha_above = at("alpha_above");
  program.termination = at("termination");
  program.opacity_limit = at("opacity_limit");
  program.brick_cells = at("brick_cells");
  program.passes_before = at("passes_before");
  gl.UseProgram(program.name);
  gl.Uniform1i(at("ray_starts"), GLint(Unit::ray_starts));
  gl.Uniform1i(at("ray_steps"), GLint(Unit::ray_steps));
  gl.Uniform1i(at("ray_ends"), GLint(Unit::ray_ends));
  gl.Uniform1i(at("field"), GLint(Unit::field));
  gl.Uniform1i(at("distances"), GLint(Unit::distances));
  gl.Uniform1i(at("table"), GLint(Unit::table));
  gl.Uniform1i(at("pages"), GLint(Unit::pages));
  gl.Uniform1i(at("sums"), GLint(Unit::sums));
  gl.Uniform1i(at("progress"), GLint(Unit::progress));
  return program;
}

}  // namespace understudy::volume::glsl
