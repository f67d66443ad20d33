// SPDX-License-Identifier: Apache-2.0
// Measures the cost of single OpenGL calls from the application's side. calls.py runs this program both bare
// and under Understudy; the program itself is independent of Understudy.
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/gl.h>
#include <GL/glext.h>
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>

namespace {

constexpr int width = 64;

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "understudy-bench-calls: %s\n", what);
  std::exit(1);
}

/// Makes current a compatibility context with a small framebuffer, without a window.
void open_context() {
  const EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (eglInitialize(display, nullptr, nullptr) == EGL_FALSE || eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) {
    fail("there is no EGL without a window system; install libegl-mesa0");
  }
  const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  const EGLint extent[] = {EGL_WIDTH, width, EGL_HEIGHT, width, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  eglChooseConfig(display, wanted, &config, 1, &count);
  const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, nullptr);
  const EGLSurface surface = eglCreatePbufferSurface(display, config, extent);
  if (count == 0 || eglMakeCurrent(display, surface, surface, context) == EGL_FALSE) fail("no OpenGL context");
}

/// Culls every triangle, so that the time of the calls is measured, not that of pixels.
void draw_no_pixels() {
  glEnable(GL_CULL_FACE);
  glCullFace(GL_FRONT_AND_BACK);
}

GLuint use_program_with_uniform() {
  const char* source = "uniform float level; void main() { gl_FragColor = vec4(level); }";
  const GLuint shader = glCreateShader(GL_FRAGMENT_SHADER);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  const GLuint program = glCreateProgram();
  glAttachShader(program, shader);
  glLinkProgram(program);
  glUseProgram(program);
  return program;
}

/// Mesa buffers vertices until glEnd; glEnd is excluded from the time.
void vertex(benchmark::State& state) {
  float x = 0;
  glBegin(GL_POINTS);
  int since_begin = 0;
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    glVertex3f(x, 0, 0);
    x += 0.001F;
    if (++since_begin == 100'000) {
      state.PauseTiming();
      glEnd();
      glFinish();
      glBegin(GL_POINTS);
      since_begin = 0;
      state.ResumeTiming();
    }
  }
  glEnd();
  glFinish();
}

void uniform(benchmark::State& state) {
  const GLuint program = use_program_with_uniform();
  const GLint location = glGetUniformLocation(program, "level");
  float level = 0;
  for (auto _ : state) glUniform1f(location, level += 0.001F);  // NOLINT(clang-analyzer-deadcode.DeadStores)
  glUseProgram(0);
  glDeleteProgram(program);
}

void point_size(benchmark::State& state) {
  float size = 1;
  for (auto _ : state) glPointSize(size = 3 - size);  // NOLINT(clang-analyzer-deadcode.DeadStores)
}

// Calls that the track unit evaluates, with almost no work for the driver.

void empty_upload(benchmark::State& state) {
  glBindTexture(GL_TEXTURE_2D, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 4, 4, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  const GLuint texel = 0;
  for (auto _ : state)  // NOLINT(clang-analyzer-deadcode.DeadStores)
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 0, 0, GL_RGBA, GL_UNSIGNED_BYTE, &texel);
  glBindTexture(GL_TEXTURE_2D, 0);
}

void empty_list(benchmark::State& state) {
  const GLuint list = glGenLists(1);
  glNewList(list, GL_COMPILE);
  glEndList();
  for (auto _ : state) glCallList(list);  // NOLINT(clang-analyzer-deadcode.DeadStores)
  glDeleteLists(list, 1);
}

void no_textures(benchmark::State& state) {
  const GLuint texture = 0;
  for (auto _ : state) glDeleteTextures(1, &texture);  // NOLINT(clang-analyzer-deadcode.DeadStores)
}

void get_viewport(benchmark::State& state) {
  GLint viewport[4];
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    glGetIntegerv(GL_VIEWPORT, viewport);
    benchmark::DoNotOptimize(viewport);
  }
}

void draw_arrays(benchmark::State& state) {
  static const GLfloat triangle[] = {0, 0, 0, 0.1F, 0, 0, 0, 0.1F, 0};
  glEnableClientState(GL_VERTEX_ARRAY);
  glVertexPointer(3, GL_FLOAT, 0, triangle);
  for (auto _ : state) glDrawArrays(GL_TRIANGLES, 0, 3);  // NOLINT(clang-analyzer-deadcode.DeadStores)
  glFinish();
  glDisableClientState(GL_VERTEX_ARRAY);
}

/// 5,000 calls, as made by programs that draw molecules without vertex arrays.
void immediate_frame(benchmark::State& state) {
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    glClear(GL_COLOR_BUFFER_BIT);
    glBegin(GL_TRIANGLES);
    for (int i = 0; i < 1665; ++i) {
      glColor3f(0.5F, 0.5F, 1);
      glNormal3f(0, 0, 1);
      glVertex3f(float(i) / 1665, 0, 0);
    }
    glEnd();
    glFlush();
  }
  glFinish();
}

constexpr int sprites = 32;

/// Makes 2-D textures, either all of one size or each of a different size.
void make_sprites(GLuint (&textures)[sprites], bool alike) {
  glGenTextures(sprites, textures);
  for (int i = 0; i < sprites; ++i) {
    glBindTexture(GL_TEXTURE_2D, textures[i]);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 32, alike ? 32 : 32 + i, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  }
}

/// Draws 400 blended quads, four from each texture before the next is bound, as programs draw icons and map
/// tiles. Every other quad uses glBegin, the others an array. The warm-up of some hundreds of frames, after
/// which Understudy has classified the program's draws, is not timed.
void sprite_frame(benchmark::State& state, bool alike) {
  static const GLfloat corners[] = {0, 0, 0.1F, 0, 0.1F, 0.1F, 0, 0.1F};
  GLuint textures[sprites];
  make_sprites(textures, alike);
  // These quads are visible, unlike the culled triangles, but cover hardly a pixel.
  glDisable(GL_CULL_FACE);
  glViewport(0, 0, 1, 1);
  glEnable(GL_TEXTURE_2D);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glEnableClientState(GL_VERTEX_ARRAY);
  glEnableClientState(GL_TEXTURE_COORD_ARRAY);
  glVertexPointer(2, GL_FLOAT, 0, corners);
  glTexCoordPointer(2, GL_FLOAT, 0, corners);
  const auto frame = [&] {
    glClear(GL_COLOR_BUFFER_BIT);
    for (int quad = 0; quad < 400; ++quad) {
      if (quad % 4 == 0) glBindTexture(GL_TEXTURE_2D, textures[quad / 4 % sprites]);
      if (quad % 2 == 0) {
        glDrawArrays(GL_QUADS, 0, 4);
        continue;
      }
      glBegin(GL_QUADS);
      for (int i = 0; i < 4; ++i) {
        glTexCoord2fv(corners + 2 * i);
        glVertex2fv(corners + 2 * i);
      }
      glEnd();
    }
    eglSwapBuffers(eglGetCurrentDisplay(), eglGetCurrentSurface(EGL_DRAW));
  };
  constexpr int warm_up = 700;
  for (int i = 0; i < warm_up; ++i) frame();
  for (auto _ : state) frame();  // NOLINT(clang-analyzer-deadcode.DeadStores)
  glFinish();
  glDisableClientState(GL_VERTEX_ARRAY);
  glDisableClientState(GL_TEXTURE_COORD_ARRAY);
  glDisable(GL_TEXTURE_2D);
  glDisable(GL_BLEND);
  glBindTexture(GL_TEXTURE_2D, 0);
  glDeleteTextures(sprites, textures);
  glViewport(0, 0, width, width);
  draw_no_pixels();
}

}  // namespace

BENCHMARK(vertex)->Name("glVertex3f");
BENCHMARK(uniform)->Name("glUniform1f");
BENCHMARK(point_size)->Name("glPointSize");
BENCHMARK(empty_upload)->Name("glTexSubImage2D");
BENCHMARK(empty_list)->Name("glCallList");
BENCHMARK(no_textures)->Name("glDeleteTextures");
BENCHMARK(get_viewport)->Name("glGetIntegerv");
BENCHMARK(draw_arrays)->Name("glDrawArrays");
BENCHMARK(immediate_frame)->Name("immediate frame");
BENCHMARK_CAPTURE(sprite_frame, different, false)->Name("textured quads");
// This one must run last: for a while, its draws look like those of a volume.
BENCHMARK_CAPTURE(sprite_frame, alike, true)->Name("textured quads, one size");

int main(int argc, char** argv) {
  open_context();
  draw_no_pixels();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
