// SPDX-License-Identifier: Apache-2.0
// The calls of a state difference bring one context into the state of another, above a real driver.
#include <EGL/egl.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "dispatch/call_id.h"
#include "dispatch/call_shape.h"
#include "gl_application.h"
#include "spu/stream/decode.h"
#include "spu/track/state.h"
#include "spu/track/track.h"

namespace understudy::spu::testing {
namespace {

using Random = std::mt19937;

struct CurrentContext {
  EGLDisplay display = eglGetCurrentDisplay();
  EGLSurface surface = eglGetCurrentSurface(EGL_DRAW);
  EGLContext context = eglGetCurrentContext();

  void make_current() const { eglMakeCurrent(display, surface, surface, context); }
};

/// Names to bind, by the query that returns them. Objects that are not shared have the same names in both
/// contexts, because both make the same ones.
using Objects = std::map<GLenum, std::vector<double>>;

const std::vector<std::pair<GLenum, GLenum>> texture_targets = {
    {GL_TEXTURE_1D, GL_TEXTURE_BINDING_1D},
    {GL_TEXTURE_2D, GL_TEXTURE_BINDING_2D},
    {GL_TEXTURE_3D, GL_TEXTURE_BINDING_3D},
    {GL_TEXTURE_CUBE_MAP, GL_TEXTURE_BINDING_CUBE_MAP},
    {GL_TEXTURE_1D_ARRAY, GL_TEXTURE_BINDING_1D_ARRAY},
    {GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY},
    {GL_TEXTURE_RECTANGLE, GL_TEXTURE_BINDING_RECTANGLE},
    {GL_TEXTURE_BUFFER, GL_TEXTURE_BINDING_BUFFER},
    {GL_TEXTURE_2D_MULTISAMPLE, GL_TEXTURE_BINDING_2D_MULTISAMPLE},
    {GL_TEXTURE_2D_MULTISAMPLE_ARRAY, GL_TEXTURE_BINDING_2D_MULTISAMPLE_ARRAY},
    {GL_TEXTURE_CUBE_MAP_ARRAY, GL_TEXTURE_BINDING_CUBE_MAP_ARRAY}};

constexpr std::array<GLenum, 13> buffer_bindings = {
    GL_UNIFORM_BUFFER_BINDING,      GL_SHADER_STORAGE_BUFFER_BINDING, GL_ATOMIC_COUNTER_BUFFER_BINDING,
    GL_ARRAY_BUFFER_BINDING,        GL_ELEMENT_ARRAY_BUFFER_BINDING,  GL_PIXEL_PACK_BUFFER_BINDING,
    GL_PIXEL_UNPACK_BUFFER_BINDING, GL_COPY_READ_BUFFER_BINDING,      GL_COPY_WRITE_BUFFER_BINDING,
    GL_TEXTURE_BUFFER_BINDING,      GL_DRAW_INDIRECT_BUFFER_BINDING,  GL_DISPATCH_INDIRECT_BUFFER_BINDING,
    GL_QUERY_BUFFER_BINDING};

int version_of(const DispatchTable& gl) {
  GLint major = 0;
  GLint minor = 0;
  gl.GetIntegerv(GL_MAJOR_VERSION, &major);
  gl.GetIntegerv(GL_MINOR_VERSION, &minor);
  return 100 * major + 10 * minor;
}

GLuint linked_program(const DispatchTable& gl) {
  const char* vertex = "#version 130\nvoid main() { gl_Position = vec4(0); }";
  const GLuint shader = gl.CreateShader(GL_VERTEX_SHADER);
  gl.ShaderSource(shader, 1, &vertex, nullptr);
  gl.CompileShader(shader);
  const GLuint program = gl.CreateProgram();
  gl.AttachShader(program, shader);
  gl.LinkProgram(program);
  return program;
}

void make_shared_objects(const DispatchTable& gl, Objects& objects) {
  for (const auto& [target, binding] : texture_targets) {
    if (version_of(gl) < 400 && target == GL_TEXTURE_CUBE_MAP_ARRAY) continue;
    std::array<GLuint, 2> names{};
    gl.GenTextures(2, names.data());
    for (const GLuint name : names) gl.BindTexture(target, name);
    gl.BindTexture(target, 0);
    objects[binding] = {0, double(names[0]), double(names[1])};
  }
  std::array<GLuint, 2> buffers{};
  gl.GenBuffers(2, buffers.data());
  for (const GLuint buffer : buffers) {
    gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl.BufferData(GL_ARRAY_BUFFER, 4096, nullptr, GL_STATIC_DRAW);
  }
  gl.BindBuffer(GL_ARRAY_BUFFER, 0);
  for (const GLenum binding : buffer_bindings) objects[binding] = {0, double(buffers[0]), double(buffers[1])};
  std::array<GLuint, 2> samplers{};
  gl.GenSamplers(2, samplers.data());
  objects[GL_SAMPLER_BINDING] = {0, double(samplers[0]), double(samplers[1])};
  objects[GL_CURRENT_PROGRAM] = {0, double(linked_program(gl)), double(linked_program(gl))};
  std::array<GLuint, 2> renderbuffers{};
  gl.GenRenderbuffers(2, renderbuffers.data());
  for (const GLuint renderbuffer : renderbuffers) {
    gl.BindRenderbuffer(GL_RENDERBUFFER, renderbuffer);
    gl.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH24_STENCIL8, 8, 8);
  }
  gl.BindRenderbuffer(GL_RENDERBUFFER, 0);
  objects[GL_RENDERBUFFER_BINDING] = {0, double(renderbuffers[0]), double(renderbuffers[1])};
}

void make_own_objects(const DispatchTable& gl, Objects& objects) {
  std::array<GLuint, 2> names{};
  // Mesa shares framebuffers as well.
  std::vector<double>& framebuffers = objects[GL_DRAW_FRAMEBUFFER_BINDING];
  if (framebuffers.empty() || gl.IsFramebuffer(GLuint(framebuffers[0])) == GL_FALSE) {
    gl.GenFramebuffers(2, names.data());
    framebuffers = {double(names[0]), double(names[1])};
  }
  objects[GL_READ_FRAMEBUFFER_BINDING] = framebuffers;
  // The stencil reference value is returned clamped to the framebuffer's stencil bits.
  for (const double name : framebuffers) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, GLuint(name));
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER,
                               GLuint(objects[GL_RENDERBUFFER_BINDING][1]));
  }
  gl.GenVertexArrays(2, names.data());
  for (const GLuint name : names) gl.BindVertexArray(name);
  objects[GL_VERTEX_ARRAY_BINDING] = {double(names[0]), double(names[1])};
  if (version_of(gl) >= 410) {
    gl.GenProgramPipelines(2, names.data());
    for (const GLuint name : names) gl.BindProgramPipeline(name);
    gl.BindProgramPipeline(0);
    objects[GL_PROGRAM_PIPELINE_BINDING] = {0, double(names[0]), double(names[1])};
  }
}

std::vector<double> range(int first, int last) {
  std::vector<double> values;
  for (int value = first; value <= last; ++value) values.push_back(value);
  return values;
}

/// Possible values of a query; empty: anything from 0 to 1.
std::vector<double> choices_of(GLenum name) {
  using Choices = std::vector<double>;
  static const Choices functions = range(GL_NEVER, GL_ALWAYS);
  static const Choices operations = {GL_KEEP, GL_ZERO, GL_REPLACE, GL_INCR, GL_DECR, GL_INVERT, GL_INCR_WRAP};
  static const Choices hints = {GL_DONT_CARE, GL_FASTEST, GL_NICEST};
  static const Choices switches = {0, 1};
  static const Choices factors = {GL_ZERO, GL_ONE, GL_SRC_COLOR, GL_DST_COLOR, GL_SRC_ALPHA, GL_CONSTANT_COLOR};
  static const Choices equations = {GL_FUNC_ADD, GL_FUNC_SUBTRACT, GL_FUNC_REVERSE_SUBTRACT, GL_MIN, GL_MAX};
  static const Choices combiners = {GL_REPLACE,    GL_MODULATE,    GL_ADD,
                                    GL_ADD_SIGNED, GL_INTERPOLATE, GL_SUBTRACT};
  static const Choices sources = {GL_TEXTURE, GL_CONSTANT, GL_PRIMARY_COLOR, GL_PREVIOUS};
  static const Choices colors = {GL_SRC_COLOR, GL_ONE_MINUS_SRC_COLOR, GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA};
  static const Choices alphas = {GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA};
  static const Choices scales = {1, 2, 4};
  static const Choices small = range(0, 90);
  static const Choices clamps = {GL_FALSE, GL_TRUE, GL_FIXED_ONLY};
  static const Choices alignments = {1, 2, 4, 8};
  static const Choices units = range(GL_TEXTURE0, GL_TEXTURE7);
  static const Choices modes = {GL_POINT, GL_LINE, GL_FILL};
  static const Choices coordinates = {GL_OBJECT_LINEAR, GL_EYE_LINEAR};
  static const std::map<GLenum, Choices> all = {
      {GL_ALPHA_TEST_FUNC, functions},
      {GL_DEPTH_FUNC, functions},
      {GL_STENCIL_FUNC, functions},
      {GL_STENCIL_BACK_FUNC, functions},
      {GL_STENCIL_FAIL, operations},
      {GL_STENCIL_PASS_DEPTH_FAIL, operations},
      {GL_STENCIL_PASS_DEPTH_PASS, operations},
      {GL_STENCIL_BACK_FAIL, operations},
      {GL_STENCIL_BACK_PASS_DEPTH_FAIL, operations},
      {GL_STENCIL_BACK_PASS_DEPTH_PASS, operations},
      {GL_STENCIL_REF, small},
      {GL_STENCIL_BACK_REF, small},
      {GL_STENCIL_VALUE_MASK, small},
      {GL_STENCIL_BACK_VALUE_MASK, small},
      {GL_STENCIL_WRITEMASK, small},
      {GL_STENCIL_BACK_WRITEMASK, small},
      {GL_STENCIL_CLEAR_VALUE, small},
      {GL_INDEX_CLEAR_VALUE, small},
      {GL_INDEX_WRITEMASK, small},
      {GL_LIST_BASE, small},
      {GL_SHADE_MODEL, {GL_FLAT, GL_SMOOTH}},
      {GL_COLOR_MATERIAL_FACE, {GL_FRONT, GL_BACK, GL_FRONT_AND_BACK}},
      {GL_COLOR_MATERIAL_PARAMETER, {GL_AMBIENT, GL_DIFFUSE, GL_SPECULAR, GL_EMISSION, GL_AMBIENT_AND_DIFFUSE}},
      {GL_LIGHT_MODEL_LOCAL_VIEWER, switches},
      {GL_LIGHT_MODEL_TWO_SIDE, switches},
      {GL_LIGHT_MODEL_COLOR_CONTROL, {GL_SINGLE_COLOR, GL_SEPARATE_SPECULAR_COLOR}},
      {GL_SPOT_EXPONENT, small},
      {GL_SPOT_CUTOFF, small},
      {GL_SHININESS, small},
      {GL_COLOR_INDEXES, small},
      {GL_FOG_MODE, {GL_LINEAR, GL_EXP, GL_EXP2}},
      {GL_FOG_COORD_SRC, {GL_FOG_COORD, GL_FRAGMENT_DEPTH}},
      {GL_TEXTURE_GEN_MODE, coordinates},
      {GL_TEXTURE_ENV_MODE, {GL_MODULATE, GL_DECAL, GL_REPLACE, GL_BLEND, GL_ADD, GL_COMBINE}},
      {GL_COMBINE_RGB, combiners},
      {GL_COMBINE_ALPHA, combiners},
      {GL_SRC0_RGB, sources},
      {GL_SRC1_RGB, sources},
      {GL_SRC2_RGB, sources},
      {GL_SRC0_ALPHA, sources},
      {GL_SRC1_ALPHA, sources},
      {GL_SRC2_ALPHA, sources},
      {GL_OPERAND0_RGB, colors},
      {GL_OPERAND1_RGB, colors},
      {GL_OPERAND2_RGB, colors},
      {GL_OPERAND0_ALPHA, alphas},
      {GL_OPERAND1_ALPHA, alphas},
      {GL_OPERAND2_ALPHA, alphas},
      {GL_RGB_SCALE, scales},
      {GL_ALPHA_SCALE, scales},
      {GL_COORD_REPLACE, switches},
      {GL_POINT_SIZE, range(1, 9)},
      {GL_POINT_SIZE_MAX, range(10, 60)},
      {GL_POINT_SPRITE_COORD_ORIGIN, {GL_LOWER_LEFT, GL_UPPER_LEFT}},
      {GL_LINE_WIDTH, range(1, 5)},
      {GL_LINE_STIPPLE_REPEAT, range(1, 9)},
      {GL_LINE_STIPPLE_PATTERN, range(1000, 1100)},
      {GL_POLYGON_MODE, modes},
      {GL_CULL_FACE_MODE, {GL_FRONT, GL_BACK, GL_FRONT_AND_BACK}},
      {GL_FRONT_FACE, {GL_CW, GL_CCW}},
      {GL_PROVOKING_VERTEX, {GL_FIRST_VERTEX_CONVENTION, GL_LAST_VERTEX_CONVENTION}},
      {GL_PRIMITIVE_RESTART_INDEX, small},
      {GL_PATCH_VERTICES, range(1, 32)},
      {GL_SAMPLE_COVERAGE_INVERT, switches},
      {GL_SAMPLE_MASK_VALUE, small},
      {GL_CLIP_ORIGIN, {GL_LOWER_LEFT, GL_UPPER_LEFT}},
      {GL_CLIP_DEPTH_MODE, {GL_NEGATIVE_ONE_TO_ONE, GL_ZERO_TO_ONE}},
      {GL_VIEWPORT, small},
      {GL_SCISSOR_BOX, small},
      {GL_PERSPECTIVE_CORRECTION_HINT, hints},
      {GL_POINT_SMOOTH_HINT, hints},
      {GL_LINE_SMOOTH_HINT, hints},
      {GL_POLYGON_SMOOTH_HINT, hints},
      {GL_FOG_HINT, hints},
      {GL_GENERATE_MIPMAP_HINT, hints},
      {GL_TEXTURE_COMPRESSION_HINT, hints},
      {GL_FRAGMENT_SHADER_DERIVATIVE_HINT, hints},
      {GL_BLEND_SRC_RGB, factors},
      {GL_BLEND_DST_RGB, factors},
      {GL_BLEND_SRC_ALPHA, factors},
      {GL_BLEND_DST_ALPHA, factors},
      {GL_BLEND_EQUATION_RGB, equations},
      {GL_BLEND_EQUATION_ALPHA, equations},
      {GL_LOGIC_OP_MODE, range(GL_CLEAR, GL_SET)},
      {GL_COLOR_WRITEMASK, switches},
      {GL_DEPTH_WRITEMASK, switches},
      {GL_CLAMP_VERTEX_COLOR, clamps},
      {GL_CLAMP_FRAGMENT_COLOR, clamps},
      {GL_CLAMP_READ_COLOR, clamps},
      {GL_PACK_SWAP_BYTES, switches},
      {GL_PACK_LSB_FIRST, switches},
      {GL_PACK_ROW_LENGTH, small},
      {GL_PACK_IMAGE_HEIGHT, small},
      {GL_PACK_SKIP_ROWS, small},
      {GL_PACK_SKIP_PIXELS, small},
      {GL_PACK_SKIP_IMAGES, small},
      {GL_PACK_ALIGNMENT, alignments},
      {GL_UNPACK_SWAP_BYTES, switches},
      {GL_UNPACK_LSB_FIRST, switches},
      {GL_UNPACK_ROW_LENGTH, small},
      {GL_UNPACK_IMAGE_HEIGHT, small},
      {GL_UNPACK_SKIP_ROWS, small},
      {GL_UNPACK_SKIP_PIXELS, small},
      {GL_UNPACK_SKIP_IMAGES, small},
      {GL_UNPACK_ALIGNMENT, alignments},
      {GL_MAP_COLOR, switches},
      {GL_MAP_STENCIL, switches},
      {GL_INDEX_SHIFT, small},
      {GL_INDEX_OFFSET, small},
      {GL_CURRENT_INDEX, small},
      {GL_EDGE_FLAG, switches},
      {GL_MATRIX_MODE, {GL_MODELVIEW, GL_PROJECTION, GL_TEXTURE}},
      {GL_CLIENT_ACTIVE_TEXTURE, units},
      {GL_ACTIVE_TEXTURE, units},
      {GL_DRAW_BUFFER, {GL_NONE, GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1}},
      {GL_READ_BUFFER, {GL_NONE, GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2}},
  };
  const auto found = all.find(name);
  return found == all.end() ? Choices{} : found->second;
}

double pick(const std::vector<double>& choices, Random& random) {
  if (choices.empty()) return double(random() % 65) / 64;
  return choices[random() % choices.size()];
}

void randomize(const StateRow& row, const Objects& objects, std::span<double> values, Random& random) {
  if (row.set == CallId::BindBufferRange) {
    const auto& buffers = objects.at(GL_ARRAY_BUFFER_BINDING);
    constexpr std::array<std::array<double, 2>, 2> extents = {{{0, 0}, {256, 64}}};
    const double buffer = pick(buffers, random);
    const auto& extent = extents[buffer == 0 ? 0 : random() % 2];
    values[0] = buffer;
    values[1] = extent[0];
    values[2] = extent[1];
    return;
  }
  if (row.set == CallId::DrawBuffers) {
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = random() % 2 == 0 ? double(GL_NONE) : double(GL_COLOR_ATTACHMENT0 + i);
    return;
  }
  std::size_t at = 0;
  for (const StateQuery& query : row.queries) {
    const auto found = objects.find(query.name);
    const bool is_switch = row.set == CallId::Enable || row.set == CallId::Enablei ||
                           row.set == CallId::EnableClientState || row.set == CallId::EnableVertexAttribArray;
    const std::vector<double> choices = is_switch                ? std::vector<double>{0, 1}
                                        : found != objects.end() ? found->second
                                                                 : choices_of(query.name);
    for (int i = 0; i < query.count; ++i) values[at++] = pick(choices, random);
  }
}

std::string name_of(const State::Item& item) {
  const char* name = enum_name(item.row->queries[0].name, 0);
  return std::string(call_name(item.row->set)) + " " + (name != nullptr ? name : "") + " of " +
         std::to_string(item.row->target) + ", number " + std::to_string(item.number);
}

void expect_equal(const State& got, const State& wanted, const std::string& what) {
  ASSERT_EQ(got.items().size(), wanted.items().size()) << what;
  for (std::size_t i = 0; i < got.items().size(); ++i) {
    const auto a = got.values(got.items()[i]);
    const auto b = wanted.values(wanted.items()[i]);
    EXPECT_EQ(std::vector(a.begin(), a.end()), std::vector(b.begin(), b.end()))
        << what << ": " << name_of(wanted.items()[i]);
  }
  EXPECT_TRUE(::testing::Test::HasFailure() || got == wanted) << what;
}

/// Makes the calls and returns which ones they were.
std::vector<CallId> apply(const Records& records, const DispatchTable& gl) {
  std::vector<CallId> calls;
  Decoder decoder;
  std::size_t position = 0;
  while (const auto record = record_at(records.words(), position, records.payload())) {
    const auto call = find_stable_id(record->id);
    EXPECT_TRUE(call);
    if (call) calls.push_back(*call);
    EXPECT_EQ(decoder.decode(*record, gl).error, "");
    const GLenum error = gl.GetError();
    EXPECT_EQ(error, GLenum(GL_NO_ERROR)) << (call ? call_name(*call) : "");
    position += record->words.size();
  }
  EXPECT_EQ(position, records.words().size());
  return calls;
}

enum class Kind { compatibility, core, version_2_1 };
constexpr std::array kinds = {Kind::compatibility, Kind::core, Kind::version_2_1};

Profile profile_of(Kind kind) {
  return kind == Kind::core ? Profile::core : Profile::compatibility;
}

/// For version 2.1, a newer driver that reports the old version.
DispatchTable table_of(Kind kind, const DispatchTable& driver) {
  DispatchTable table = driver;
  if (kind == Kind::version_2_1) {
    table.GetString = [](GLenum) { return reinterpret_cast<const GLubyte*>("2.1 Tests"); };
  }
  return table;
}

class StateDifference : public ::testing::TestWithParam<Kind> {
 protected:
  void SetUp() override {
    first_ = GlApplication::start(profile_of(GetParam()));
    if (!first_) GTEST_SKIP() << "no EGL context here";
    first_context_ = CurrentContext();
    first_->use_chain(false);
    gl_ = table_of(GetParam(), first_->driver());
    make_shared_objects(gl(), objects_);
    make_own_objects(gl(), objects_);
    const Objects before = objects_;
    second_ = first_->start_companion();
    ASSERT_TRUE(second_);
    second_context_ = CurrentContext();
    second_->use_chain(false);
    make_own_objects(gl(), objects_);
    ASSERT_EQ(before, objects_);
    ASSERT_EQ(gl().GetError(), GLenum(GL_NO_ERROR));
  }

  const DispatchTable& gl() const { return gl_; }
  void use_first() const { first_context_.make_current(); }
  void use_second() const { second_context_.make_current(); }

  /// While GL_COLOR_MATERIAL is enabled, the material is not independent state.
  State random_state(State state, Random& random) const {
    for (const State::Item& item : state.items()) {
      if (item.row->queries[0].name == GL_COLOR_MATERIAL) continue;
      randomize(*item.row, objects_, state.values(item), random);
    }
    return state;
  }

  State read() const {
    State state = read_state(gl());
    EXPECT_EQ(gl().GetError(), GLenum(GL_NO_ERROR)) << "asking left an error";
    return state;
  }

  DispatchTable gl_{};
  Objects objects_;
  std::unique_ptr<GlApplication> first_;
  std::unique_ptr<GlApplication> second_;
  CurrentContext first_context_;
  CurrentContext second_context_;
};

TEST_P(StateDifference, MakesOneContextLikeAnother) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    use_first();
    const State before = read();
    const State wanted = random_state(before, random);
    std::size_t changed = 0;
    for (std::size_t i = 0; i < wanted.items().size(); ++i) {
      const auto a = before.values(before.items()[i]);
      const auto b = wanted.values(wanted.items()[i]);
      changed += std::equal(a.begin(), a.end(), b.begin()) ? 0 : 1;
    }
    EXPECT_GE(changed, 300U);
    apply(difference(before, wanted), gl());
    expect_equal(read(), wanted, "the first context");
    if (GetParam() != Kind::core && seed % 2 == 0) {
      gl().Enable(GL_COLOR_MATERIAL);
      gl().Color4f(0.25F, float(seed) / 16, 0.75F, 0.5F);
    }
    const State first = read();
    use_second();
    apply(difference(read(), first), gl());
    expect_equal(read(), first, "the second context");
    if (HasFailure()) return;
    use_first();
    if (GetParam() != Kind::core) gl().Disable(GL_COLOR_MATERIAL);
  }
}

TEST_P(StateDifference, OfEqualStatesIsNothing) {
  Random random(5);
  use_first();
  apply(difference(read(), random_state(read(), random)), gl());
  EXPECT_TRUE(difference(read(), read()).empty());
}

TEST_P(StateDifference, OfOneItemIsItsCall) {
  use_first();
  if (GetParam() != Kind::core) {
    // Enabling GL_COLOR_MATERIAL sets the material to the current colour.
    constexpr std::array<GLfloat, 4> white = {1, 1, 1, 1};
    gl().Materialfv(GL_FRONT_AND_BACK, GL_AMBIENT_AND_DIFFUSE, white.data());
  }
  const State before = read();
  std::map<const StateRow*, int> exercised;
  Random random(7);
  for (const State::Item& item : before.items()) {
    int& count = exercised[item.row];
    // Of many similar items: the first, the second and some others.
    if (count >= 2 && random() % 16 != 0) continue;
    SCOPED_TRACE(name_of(item));
    State wanted = before;
    for (int attempt = 0; attempt < 200 && wanted == before; ++attempt)
      randomize(*item.row, objects_, wanted.values(item), random);
    ASSERT_FALSE(wanted == before) << "no value of this row differs from where it starts";
    ++count;
    const auto others = [&](const std::vector<CallId>& calls) {
      std::size_t sum = 0;
      for (const CallId call : calls) {
        const bool selects =
            call == CallId::ActiveTexture || call == CallId::ClientActiveTexture || call == CallId::MatrixMode;
        sum += selects && item.row->group != StateGroup::selectors ? 0 : 1;
      }
      return sum;
    };
    const auto there = apply(difference(before, wanted), gl());
    const State got = read();
    switch (item.row->group) {
      case StateGroup::framebuffer:
      case StateGroup::vertex_array:
        // Another object may have different contents.
        EXPECT_GE(others(there), 1U);
        break;
      case StateGroup::indexed_buffers:
        EXPECT_LE(others(there), 2U) << "and the binding of the target itself";
        break;
      default:
        EXPECT_EQ(others(there), 1U);
    }
    expect_equal(got, wanted, "there");
    apply(difference(got, before), gl());
    expect_equal(read(), before, "and back");
    if (HasFailure()) return;
  }
  std::size_t rows = 0;
  for (const auto& [row, count] : exercised) rows += count > 0 ? 1 : 0;
  EXPECT_EQ(rows, exercised.size());
  std::printf("%zu rows, %zu items\n", rows, before.items().size());
}

INSTANTIATE_TEST_SUITE_P(Contexts, StateDifference, ::testing::ValuesIn(kinds), [](const auto& info) {
  return info.param == Kind::core ? "Core" : info.param == Kind::compatibility ? "Compatibility" : "Version21";
});

TEST(StateRows, AreAllAskedOfSomeContext) {
  std::set<const StateRow*> asked;
  for (const Kind kind : kinds) {
    const auto application = GlApplication::start(profile_of(kind));
    if (!application) GTEST_SKIP() << "no EGL context here";
    const State state = read_state(table_of(kind, application->driver()));
    for (const State::Item& item : state.items()) asked.insert(item.row);
    application->use_chain(false);
  }
  for (const StateRow& row : state_rows()) {
    EXPECT_TRUE(asked.contains(&row)) << call_name(row.set) << " " << std::hex << row.queries[0].name;
  }
}

class CompatibilityState : public StateDifference {};

/// State set by an application's own calls, and queried by the test itself.
TEST_P(CompatibilityState, IsWhatTheApplicationsCallsMadeIt) {
  use_first();
  const auto& gl = this->gl();
  gl.MatrixMode(GL_MODELVIEW);
  gl.LoadIdentity();
  gl.Rotatef(30, 1, 2, 3);
  gl.Translatef(0.5F, -2, 1);
  const std::array<GLfloat, 4> position = {1, 2, 3, 1};
  const std::array<GLdouble, 4> plane = {0.5, 1, -1, 0.25};
  gl.Lightfv(GL_LIGHT2, GL_POSITION, position.data());
  gl.Lightfv(GL_LIGHT2, GL_SPOT_DIRECTION, position.data());
  gl.ClipPlane(GL_CLIP_PLANE1, plane.data());
  gl.ActiveTexture(GL_TEXTURE3);
  gl.TexGendv(GL_T, GL_EYE_PLANE, plane.data());
  gl.MatrixMode(GL_TEXTURE);
  gl.Scalef(2, 3, 4);
  gl.ColorMaterial(GL_FRONT, GL_SPECULAR);
  gl.Enable(GL_COLOR_MATERIAL);
  gl.Color3f(0.125F, 0.25F, 0.5F);
  gl.StencilFunc(GL_LESS, 3, 0xffffffffU);
  gl.PixelStorei(GL_UNPACK_ROW_LENGTH, 77);
  gl.Viewport(1, 2, 33, 44);
  gl.PolygonMode(GL_BACK, GL_LINE);
  gl.MatrixMode(GL_PROJECTION);
  ASSERT_EQ(gl.GetError(), GLenum(GL_NO_ERROR));

  struct Answers {
    std::array<GLfloat, 4> position{}, direction{}, specular{};
    std::array<GLdouble, 4> plane{}, eye{};
    std::array<GLdouble, 16> modelview{}, texture{};
    std::array<GLint, 8> integers{};
    bool operator==(const Answers&) const = default;
  };
  const auto ask = [&gl] {
    Answers a;
    gl.GetLightfv(GL_LIGHT2, GL_POSITION, a.position.data());
    gl.GetLightfv(GL_LIGHT2, GL_SPOT_DIRECTION, a.direction.data());
    gl.GetMaterialfv(GL_FRONT, GL_SPECULAR, a.specular.data());
    gl.GetClipPlane(GL_CLIP_PLANE1, a.plane.data());
    gl.GetTexGendv(GL_T, GL_EYE_PLANE, a.eye.data());
    gl.GetDoublev(GL_MODELVIEW_MATRIX, a.modelview.data());
    gl.GetDoublev(GL_TEXTURE_MATRIX, a.texture.data());
    gl.GetIntegerv(GL_UNPACK_ROW_LENGTH, &a.integers[0]);
    gl.GetIntegerv(GL_MATRIX_MODE, &a.integers[1]);
    gl.GetIntegerv(GL_STENCIL_REF, &a.integers[2]);
    gl.GetIntegerv(GL_STENCIL_VALUE_MASK, &a.integers[3]);
    gl.GetIntegerv(GL_VIEWPORT, &a.integers[4]);
    return a;
  };
  const Answers wanted = ask();
  EXPECT_EQ(wanted.specular, (std::array<GLfloat, 4>{0.125F, 0.25F, 0.5F, 1}));
  const State first = read();
  use_second();
  EXPECT_FALSE(ask() == wanted);
  apply(difference(read(), first), gl);
  EXPECT_TRUE(ask() == wanted);
  expect_equal(read(), first, "the second context");
  std::array<GLint, 2> modes{};
  gl.GetIntegerv(GL_POLYGON_MODE, modes.data());
  EXPECT_EQ(modes, (std::array<GLint, 2>{GL_FILL, GL_LINE}));
}

TEST_P(CompatibilityState, OfTrackIsThatOfItsContext) {
  use_second();
  second_->use_chain(true);
  second_->gl().LineWidth(3);
  const Track* track = Chain::current()->find<Track>();
  ASSERT_NE(track, nullptr);
  const State state = track->state();
  EXPECT_TRUE(state == read());
  EXPECT_EQ(state.values(*state.find(CallId::LineWidth, GL_LINE_WIDTH))[0], 3);
  second_->use_chain(false);
}

INSTANTIATE_TEST_SUITE_P(Contexts, CompatibilityState, ::testing::Values(Kind::compatibility),
                         [](const auto&) { return "Compatibility"; });

}  // namespace
}  // namespace understudy::spu::testing
