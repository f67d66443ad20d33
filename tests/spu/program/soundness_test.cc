// SPDX-License-Identifier: Apache-2.0
// A source that is not listed has no influence: checked with random shaders on a real driver.
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <gmock/gmock.h>

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "spu/volume/program/influences.h"
#include "tests/all_cases.h"
#include "tests/spu/program/random_shader.h"
#include "tests/spu/program/shader_facts.h"

namespace understudy::spu::program::testing {
namespace {

/// A core context without a window, with one float pixel to draw to.
class OnePixel {
 public:
  OnePixel() {
    const auto platform = PFNEGLGETPLATFORMDISPLAYEXTPROC(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (platform != nullptr) display_ = platform(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display_ == EGL_NO_DISPLAY || eglInitialize(display_, nullptr, nullptr) == EGL_FALSE) return;
    eglBindAPI(EGL_OPENGL_API);
    const std::array<EGLint, 5> wanted{EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
    context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted.data());
    if (context_ == EGL_NO_CONTEXT) return;
    works_ = eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_FALSE;
    if (works_) make_target();
  }
  ~OnePixel() {
    if (context_ == EGL_NO_CONTEXT) return;
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
  }
  OnePixel(const OnePixel&) = delete;
  OnePixel& operator=(const OnePixel&) = delete;

  bool works() const { return works_; }

  /// Returns nullopt if the fragment is discarded.
  std::optional<std::array<float, 4>> draw() {
    const std::array<float, 4> untouched{-77, -77, -77, -77};
    glClearBufferfv(GL_COLOR, 0, untouched.data());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    std::array<float, 4> pixel{};
    glReadPixels(0, 0, 1, 1, GL_RGBA, GL_FLOAT, pixel.data());
    if (pixel == untouched) return std::nullopt;
    return pixel;
  }

 private:
  static void make_target() {
    GLuint name = 0;
    glGenTextures(1, &name);
    glBindTexture(GL_TEXTURE_2D, name);
    glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA32F, 1, 1);
    GLuint framebuffer = 0;
    glGenFramebuffers(1, &framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, name, 0);
    GLuint arrays = 0;
    glGenVertexArrays(1, &arrays);
    glBindVertexArray(arrays);
    glViewport(0, 0, 1, 1);
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  bool works_ = false;
};

/// All scalars that shader() reads, in the order of their uniforms.
constexpr std::size_t inputs = 17;

Source input(std::size_t i) {
  if (i < 8) return {.kind = SourceKind::varying, .name = i < 4 ? "a" : "b", .component = int(i % 4)};
  if (i < 12) return {.kind = SourceKind::uniform, .name = "u", .component = int(i - 8)};
  if (i < 16) return {.kind = SourceKind::uniform, .name = "list[" + std::to_string(i - 12) + "]"};
  return {.kind = SourceKind::uniform, .name = "k"};
}

GLuint compiled(GLenum stage, const std::string& text) {
  const GLuint shader = glCreateShader(stage);
  const char* source = text.c_str();
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint works = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &works);
  std::array<char, 1000> log{};
  glGetShaderInfoLog(shader, GLsizei(log.size()), nullptr, log.data());
  EXPECT_TRUE(works) << log.data() << text;
  return shader;
}

/// Varyings are set from uniforms, so that each can be changed separately.
class Program {
 public:
  explicit Program(const std::string& fragment) : name_(glCreateProgram()) {
    const std::string vertex =
        "#version 330\nuniform vec4 from_a, from_b; out vec4 a, b;\n"
        "void main() { a = from_a; b = from_b; gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 "
        "? 3 : -1, "
        "0, 1); }\n";
    for (const GLuint shader : {compiled(GL_VERTEX_SHADER, vertex), compiled(GL_FRAGMENT_SHADER, fragment)}) {
      glAttachShader(name_, shader);
      glDeleteShader(shader);
    }
    glLinkProgram(name_);
    glUseProgram(name_);
    glUniform1i(glGetUniformLocation(name_, "table"), 1);
  }
  ~Program() { glDeleteProgram(name_); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void set(const std::array<float, inputs>& values) const {
    glUniform4fv(glGetUniformLocation(name_, "from_a"), 1, &values[0]);
    glUniform4fv(glGetUniformLocation(name_, "from_b"), 1, &values[4]);
    glUniform4fv(glGetUniformLocation(name_, "u"), 1, &values[8]);
    glUniform1fv(glGetUniformLocation(name_, "list"), 4, &values[12]);
    glUniform1i(glGetUniformLocation(name_, "k"), int(values[16] * 3.9F));
  }

 private:
  GLuint name_;
};

/// Random contents, without two equal texels.
void make_textures(std::mt19937& chance) {
  std::array<float, 4 * 4 * 4 * 4> texels{};
  for (float& texel : texels) texel = std::uniform_real_distribution<float>(0, 1)(chance);
  for (const GLenum target : {GL_TEXTURE_3D, GL_TEXTURE_1D}) {
    GLuint name = 0;
    glGenTextures(1, &name);
    glActiveTexture(target == GL_TEXTURE_3D ? GL_TEXTURE0 : GL_TEXTURE1);
    glBindTexture(target, name);
    if (target == GL_TEXTURE_3D)
      glTexImage3D(target, 0, GL_RGBA32F, 4, 4, 4, 0, GL_RGBA, GL_FLOAT, texels.data());
    else
      glTexImage1D(target, 0, GL_RGBA32F, 16, 0, GL_RGBA, GL_FLOAT, texels.data());
    glTexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  }
}

/// For each output component, and for discards: the inputs that may have an influence, including through
/// textures.
struct Listed {
  std::array<std::array<bool, inputs>, 4> colour{};
  std::array<bool, inputs> discard{};
};

std::array<bool, inputs> flags(const StageFacts& facts) {
  std::array<bool, inputs> flags{};
  for (const Influence& influence : influences(facts, {})) {
    const Source& source = facts.sources[influence.source];
    for (std::size_t i = 0; i < inputs; ++i) {
      const Source other = input(i);
      flags[i] |= source.kind == other.kind && source.name == other.name && source.component == other.component;
    }
  }
  return flags;
}

Listed listed(const StageFacts& facts) {
  Listed listed;
  StageFacts part = facts;
  part.outputs.clear();
  listed.discard = flags(part);
  part.discards.clear();
  for (const Output& output : facts.outputs) {
    part.outputs = {output};
    listed.colour.at(std::size_t(output.component)) = flags(part);
  }
  return listed;
}

bool same(float a, float b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

struct Tried {
  int influences = 0;  ///< number listed
  int seen = 0;        ///< number of these that had a visible effect
};

void try_inputs(OnePixel& pixel, const std::string& text, std::mt19937& chance, Tried& tried) {
  const Listed may = listed(facts_of(text));
  const Program program(text);
  std::uniform_real_distribution<float> value(0, 1);
  Listed seen;
  for (int round = 0; round < 6; ++round) {
    std::array<float, inputs> values{};
    for (float& number : values) number = value(chance);
    program.set(values);
    const auto before = pixel.draw();
    for (std::size_t i = 0; i < inputs; ++i) {
      std::array<float, inputs> changed = values;
      changed[i] = value(chance);
      program.set(changed);
      const auto after = pixel.draw();
      seen.discard[i] |= before.has_value() != after.has_value();
      if (!before || !after) continue;
      for (std::size_t c = 0; c < 4; ++c) seen.colour[c][i] |= !same((*before)[c], (*after)[c]);
    }
  }
  for (std::size_t i = 0; i < inputs; ++i) {
    EXPECT_TRUE(may.discard[i] || !seen.discard[i]) << input(i).name << " discards in\n" << text;
    for (std::size_t c = 0; c < 4; ++c) {
      EXPECT_TRUE(may.colour[c][i] || !seen.colour[c][i])
          << input(i).name << " " << input(i).component << " reaches colour " << c << " in\n"
          << text;
      tried.influences += may.colour[c][i] ? 1 : 0;
      tried.seen += seen.colour[c][i] ? 1 : 0;
    }
  }
}

bool is_too_large(const std::string& shader) {
  const std::vector<std::string> sources{shader};
  const StageFinding finding = analyse(Stage::fragment, sources);
  const auto* failure = std::get_if<Failure>(&finding);
  return failure != nullptr && failure->kind == Failure::Kind::too_large;
}

TEST(Facts, ListEverySourceThatHasAnInfluence) {
  OnePixel pixel;
  if (!pixel.works()) GTEST_SKIP() << "no EGL without a window here";
  const char* asked = std::getenv("UNDERSTUDY_SHADERS");
  const unsigned usual = takes_all_cases() ? 60 : 20;
  const unsigned shaders = asked == nullptr ? usual : unsigned(std::atoi(asked));
  const unsigned seed = std::random_device()();
  std::mt19937 chance(seed);
  make_textures(chance);
  Tried tried;
  for (unsigned i = 0; i < shaders && !::testing::Test::HasFailure(); ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", shader " + std::to_string(i));
    const std::string shader = RandomShader(seed + i).text();
    // Shaders too large to analyse are refused, so there is no claim to check.
    if (is_too_large(shader)) continue;
    try_inputs(pixel, shader, chance, tried);
  }
  RecordProperty("listed", tried.influences);
  RecordProperty("seen", tried.seen);
  std::printf("seed %u: %d influences listed, %d of them seen\n", seed, tried.influences, tried.seen);
}

}  // namespace
}  // namespace understudy::spu::program::testing
