// SPDX-License-Identifier: Apache-2.0
// Draws in one context after another: each draws a volume as slices, twice, and is destroyed.
//
//   contexts immediate|buffer|list COUNT
//
// Prints how many KiB of memory each context left behind; draws off screen.
#include <EGL/egl.h>
#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

namespace {

constexpr int side = 16;
constexpr int window = 64;

[[noreturn]] void stop(const char* what) {
  std::fprintf(stderr, "contexts: %s\n", what);
  std::exit(2);
}

long resident_kib() {
  std::FILE* const file = std::fopen("/proc/self/statm", "re");
  long mapped = 0;
  long resident = 0;
  if (file == nullptr || std::fscanf(file, "%ld %ld", &mapped, &resident) != 2) stop("there is no /proc");
  std::fclose(file);
  return resident * (sysconf(_SC_PAGESIZE) / 1024);
}

long median(std::span<long> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

struct Vertex {
  std::array<float, 3> coordinate;
  std::array<float, 3> position;
};

std::vector<Vertex> slices() {
  std::vector<Vertex> vertices;
  for (int z = 0; z < side; ++z) {
    const float depth = (float(z) + 0.5F) / side;
    for (const auto& [x, y] :
         {std::array{0.F, 0.F}, std::array{1.F, 0.F}, std::array{1.F, 1.F}, std::array{0.F, 1.F}})
      vertices.push_back({{x, y, depth}, {2 * x - 1, 2 * y - 1, 1 - 2 * depth}});
  }
  return vertices;
}

void draw_one_by_one(const std::vector<Vertex>& vertices) {
  glBegin(GL_QUADS);
  for (const Vertex& vertex : vertices) {
    glTexCoord3fv(vertex.coordinate.data());
    glVertex3fv(vertex.position.data());
  }
  glEnd();
}

void draw_from_buffer(const std::vector<Vertex>& vertices) {
  GLuint buffer = 0;
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(vertices.size() * sizeof(Vertex)), vertices.data(), GL_STATIC_DRAW);
  glInterleavedArrays(GL_V3F, sizeof(Vertex), reinterpret_cast<const void*>(sizeof(Vertex::coordinate)));
  glTexCoordPointer(3, GL_FLOAT, sizeof(Vertex), nullptr);
  glEnableClientState(GL_TEXTURE_COORD_ARRAY);
  glDrawArrays(GL_QUADS, 0, GLsizei(vertices.size()));
  glDeleteBuffers(1, &buffer);
}

void draw_from_list(const std::vector<Vertex>& vertices) {
  const GLuint list = glGenLists(1);
  glNewList(list, GL_COMPILE);
  draw_one_by_one(vertices);
  glEndList();
  glCallList(list);
  glDeleteLists(list, 1);
}

void draw_volume(void (*draw)(const std::vector<Vertex>&), int number) {
  const std::vector<unsigned char> texels(std::size_t(2 * side * side * side), (unsigned char)(number % 64));
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_3D, texture);
  glTexImage3D(GL_TEXTURE_3D, 0, GL_LUMINANCE_ALPHA, side, side, side, 0, GL_LUMINANCE_ALPHA, GL_UNSIGNED_BYTE,
               texels.data());
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glEnable(GL_TEXTURE_3D);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glClear(GL_COLOR_BUFFER_BIT);
  draw(slices());
  glFinish();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) stop("usage: contexts immediate|buffer|list COUNT");
  const int count = std::atoi(argv[2]);
  if (count < 30) stop("fewer than 30 contexts tell nothing");
  const bool buffer = std::strcmp(argv[1], "buffer") == 0;
  auto* const draw = buffer                              ? &draw_from_buffer
                     : std::strcmp(argv[1], "list") == 0 ? &draw_from_list
                                                         : &draw_one_by_one;
  EGLDisplay const display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
  if (!eglInitialize(display, nullptr, nullptr) || !eglBindAPI(EGL_OPENGL_API)) stop("there is no EGL display");
  const std::array<EGLint, 7> wanted = {
      EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_ALPHA_SIZE, 8, EGL_NONE};
  const std::array<EGLint, 5> size = {EGL_WIDTH, window, EGL_HEIGHT, window, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint configs = 0;
  if (!eglChooseConfig(display, wanted.data(), &config, 1, &configs) || configs == 0)
    stop("there is no EGL config");
  std::vector<long> resident;
  for (int i = 0; i < count; ++i) {
    EGLContext const context = eglCreateContext(display, config, EGL_NO_CONTEXT, nullptr);
    EGLSurface const surface = eglCreatePbufferSurface(display, config, size.data());
    if (!eglMakeCurrent(display, surface, surface, context)) stop("there is no context");
    for (int frame = 0; frame < 2; ++frame) {
      draw_volume(draw, i);
      eglSwapBuffers(display, surface);
    }
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroySurface(display, surface);
    eglDestroyContext(display, context);
    resident.push_back(resident_kib());
  }
  // One-time allocations have been made after a third of the contexts. The allocator's reserve varies, hence
  // medians.
  const std::size_t tenth = resident.size() / 10;
  const long before = median(std::span(resident).subspan(resident.size() / 3, tenth));
  const long after = median(std::span(resident).last(tenth));
  std::printf("%.1f KiB a context\n", double(after - before) / (0.6 * count));
}
