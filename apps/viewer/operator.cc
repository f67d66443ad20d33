// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/operator.h"

#include <GL/glew.h>

#include <array>
#include <utility>

namespace viewer {

namespace {

struct Blend {
  Operator op;
  std::string_view name;
  GLenum source, destination, equation;
  BlendNames names;
};

constexpr std::array<Blend, 5> blends = {
    {{Operator::over,
      "over",
      GL_SRC_ALPHA,
      GL_ONE_MINUS_SRC_ALPHA,
      GL_FUNC_ADD,
      {"GL_SRC_ALPHA", "GL_ONE_MINUS_SRC_ALPHA", "GL_FUNC_ADD"}},
     {Operator::under,
      "under",
      GL_ONE_MINUS_DST_ALPHA,
      GL_ONE,
      GL_FUNC_ADD,
      {"GL_ONE_MINUS_DST_ALPHA", "GL_ONE", "GL_FUNC_ADD"}},
     {Operator::max, "max", GL_ONE, GL_ONE, GL_MAX, {"GL_ONE", "GL_ONE", "GL_MAX"}},
     {Operator::min, "min", GL_ONE, GL_ONE, GL_MIN, {"GL_ONE", "GL_ONE", "GL_MIN"}},
     {Operator::add, "add", GL_SRC_ALPHA, GL_ONE, GL_FUNC_ADD, {"GL_SRC_ALPHA", "GL_ONE", "GL_FUNC_ADD"}}}};

const Blend& blend_of(Operator op) {
  return blends[static_cast<std::size_t>(op)];
}

}  // namespace

std::string_view name_of(Operator op) {
  return blend_of(op).name;
}

std::optional<Operator> operator_named(std::string_view name) {
  for (const Blend& blend : blends)
    if (blend.name == name) return blend.op;
  return std::nullopt;
}

BlendNames blend_names(Operator op) {
  return blend_of(op).names;
}

void blend_with(Operator op) {
  const Blend& blend = blend_of(op);
  glEnable(GL_BLEND);
  glBlendFunc(blend.source, blend.destination);
  // Before OpenGL 1.4, addition was the only equation, so `over` does not set it.
  if (op != Operator::over) glBlendEquation(blend.equation);
}

Table colours_for(Operator op, const Table& table) {
  Table colours = table;
  for (std::size_t i = 0; i < colours.size(); ++i) {
    Rgba8& colour = colours[i];
    if (op == Operator::under) {
      for (std::size_t channel = 0; channel < 3; ++channel)
        colour[channel] = static_cast<std::uint8_t>((colour[channel] * colour[3] + 127) / 255);
    } else if (op == Operator::max || op == Operator::min) {
      colour.fill(static_cast<std::uint8_t>(i));
    }
  }
  return colours;
}

}  // namespace viewer
