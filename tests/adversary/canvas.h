// SPDX-License-Identifier: Apache-2.0
// What a scenario draws on: a window, or, for the exact reference, a framebuffer of 32-bit floats in its place.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/adversary/gl.h"
#include "tests/adversary/window.h"

namespace adversary {

/// `viewer`: as a viewer draws, with 8 bits a channel. `exact`: the window and normalised volumes are kept as
/// floats, so that blending and filtering round nothing away. What both differ by is what may legitimately
/// differ.
enum class Precision { viewer, exact };

class Canvas {
  Window window_;  // first: the functions below are loaded while its context is current

 public:
  Canvas(Profile profile, Precision precision, int width, int height);

  const Gl gl;

  int width() const { return width_; }
  int height() const { return height_; }
  bool exact() const { return precision_ == Precision::exact; }
  /// Scenarios bind this one where a viewer would bind 0.
  GLuint framebuffer() const { return framebuffer_; }
  /// Of framebuffer objects: `format` for viewers, 32-bit floats for the exact reference.
  GLenum colour_format(GLenum format) const { return exact() ? GL_RGBA32F : format; }

  /// Binds the window's framebuffer, sets the viewport to all of it, and clears it.
  void begin(float red = 0, float green = 0, float blue = 0, float alpha = 1) const;
  void resize(int width, int height);
  /// Rows from below, RGBA of 8 bits each.
  std::vector<std::uint8_t> read() const;
  void swap() { window_.swap(); }

  /// Something else that the program has seen (the result of a query). It must not depend on who draws the
  /// volume.
  void note(const std::string& fact) { facts_.push_back(fact); }
  const std::vector<std::string>& facts() const { return facts_; }

 private:
  void create_exact_framebuffer();

  Precision precision_;
  int width_;
  int height_;
  GLuint framebuffer_ = 0;
  std::vector<std::string> facts_;
};

}  // namespace adversary
