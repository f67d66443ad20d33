// SPDX-License-Identifier: Apache-2.0
// An image made of many kinds of calls, a digest of its pixels, and a volume in slices.
#pragma once

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
#include <stdio.h>

#include <cmath>
#include <cstdint>
#include <vector>

namespace client {

constexpr int image_size = 64;

inline std::uint64_t digest(const std::vector<unsigned char>& bytes) {
  std::uint64_t hash = 14695981039346656037U;  // FNV-1a
  for (const unsigned char byte : bytes) hash = (hash ^ byte) * 1099511628211U;
  return hash;
}

inline std::vector<unsigned char> read_pixels() {
  std::vector<unsigned char> pixels(std::size_t(4) * image_size * image_size);
  glReadPixels(0, 0, image_size, image_size, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  return pixels;
}

/// A checkerboard of 8 x 8 texels. `seed` makes images different.
inline GLuint checkerboard(int seed) {
  unsigned char texels[8 * 8 * 4];
  for (int i = 0; i < 8 * 8; ++i) {
    const bool light = ((i % 8) + (i / 8)) % 2 != 0;
    texels[4 * i] = static_cast<unsigned char>(light ? 250 : 20 + seed % 100);
    texels[4 * i + 1] = static_cast<unsigned char>(seed * 37);
    texels[4 * i + 2] = static_cast<unsigned char>(4 * i);
    texels[4 * i + 3] = 255;
  }
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 8, 8, 0, GL_RGBA, GL_UNSIGNED_BYTE, texels);
  return texture;
}

/// Draws with a texture, blending, a depth test and a scissor.
inline void draw_image(GLuint texture, int seed) {
  const float shade = float(seed % 10) / 10;
  glViewport(0, 0, image_size, image_size);
  glMatrixMode(GL_PROJECTION);
  glLoadIdentity();
  glMatrixMode(GL_MODELVIEW);
  glLoadIdentity();
  glClearColor(shade, 0.5F, 1 - shade, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_TEXTURE_2D);
  glBindTexture(GL_TEXTURE_2D, texture);
  glColor4f(1, 1, 1, 1);
  glBegin(GL_TRIANGLE_STRIP);
  for (int i = 0; i < 4; ++i) {
    glTexCoord2i(i % 2, i / 2);
    glVertex3f(0.8F * (i % 2 != 0 ? 1.0F : -1.0F), 0.7F * (i >= 2 ? 1.0F : -1.0F), 0.2F);
  }
  glEnd();
  glDisable(GL_TEXTURE_2D);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glRotatef(float(seed), 0, 0, 1);
  glBegin(GL_TRIANGLES);
  glColor4f(1, 0, shade, 0.5F);
  glVertex3f(-0.9F, -0.5F, 0.1F);
  glColor4f(0, 1, shade, 0.9F);
  glVertex3f(0.9F, -0.5F, 0.3F);
  glVertex3f(0, 0.9F, -0.1F);
  glEnd();
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_SCISSOR_TEST);
  glScissor(3, 3, 9, 9);
  glClearColor(0, shade, 1, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  glDisable(GL_SCISSOR_TEST);
}

/// Draws an image, reads it back, and prints its digest.
inline void show(const char* name, int seed) {
  const GLuint texture = checkerboard(seed);
  draw_image(texture, seed);
  printf("%s: %016lx error %x\n", name, digest(read_pixels()), glGetError());
  glDeleteTextures(1, &texture);
  fflush(stdout);
}

/// A ball with a hole, as colours.
inline GLuint ball_texture() {
  constexpr int n = 24;
  std::vector<unsigned char> texels;
  for (int i = 0; i < n * n * n; ++i) {
    const double x = (i % n + 0.5) / n - 0.5;
    const double y = (double(i / n % n) + 0.5) / n - 0.5;
    const double z = (double(i / n / n) + 0.5) / n - 0.5;
    const double radius = std::sqrt(x * x + y * y + z * z);
    const double density = radius < 0.15 || radius > 0.45 ? 0 : std::sin((radius - 0.15) / 0.3 * 3.14159265);
    for (const double value : {200 * density, 255 - 255 * density, 90.0 + 100 * x, 50 * density})
      texels.push_back(static_cast<unsigned char>(value));
  }
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_3D, texture);
  for (const GLenum name : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_3D, name, GL_LINEAR);
  for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTexParameteri(GL_TEXTURE_3D, name, GL_CLAMP_TO_EDGE);
  glTexImage3D(GL_TEXTURE_3D, 0, GL_RGBA8, n, n, n, 0, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
  return texture;
}

/// Slices through a 3-D texture, back to front: a volume that Understudy substitutes.
inline void draw_volume(GLuint texture, double angle) {
  constexpr int slices = 40;
  glViewport(0, 0, image_size, image_size);
  glClearColor(0.1F, 0.2F, 0.3F, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glMatrixMode(GL_PROJECTION);
  glLoadIdentity();
  glFrustum(-0.3, 0.3, -0.3, 0.3, 1, 10);
  glMatrixMode(GL_MODELVIEW);
  glLoadIdentity();
  glTranslated(0, 0, -3);
  glRotated(angle, 0.2, 1, 0.1);
  glTranslated(-0.5, -0.5, -0.5);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glEnable(GL_TEXTURE_3D);
  glBindTexture(GL_TEXTURE_3D, texture);
  glColor4f(1, 1, 1, 1);
  for (int i = 0; i < slices; ++i) {
    const double z = (i + 0.5) / slices;
    glBegin(GL_QUADS);
    for (int corner = 0; corner < 4; ++corner) {
      const double x = corner == 1 || corner == 2 ? 1 : 0;
      const double y = corner >= 2 ? 1 : 0;
      glTexCoord3d(x, y, z);
      glVertex3d(x, y, z);
    }
    glEnd();
  }
  glDisable(GL_TEXTURE_3D);
  glDisable(GL_BLEND);
}

inline void write_file(const char* path, const std::vector<unsigned char>& bytes) {
  FILE* file = fopen(path, "wb");
  if (file == nullptr || fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size())
    printf("cannot write %s\n", path);
  if (file != nullptr) fclose(file);
}

}  // namespace client
