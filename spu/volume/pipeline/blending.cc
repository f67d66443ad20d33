// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/pipeline/blending.h"

#include <array>
#include <variant>

#include "spu/state_value.h"

namespace understudy::spu {
namespace {

using volume::Operator;

struct Factors {
  GLint source = 0;
  GLint destination = 0;
  bool operator==(const Factors&) const = default;
};

/// Returns the operator of a blend equation without factors.
std::optional<Operator> extremum(GLint equation) {
  if (equation == GL_MAX) return Operator::max;
  if (equation == GL_MIN) return Operator::min;
  return std::nullopt;
}

/// Front-to-back blending needs an alpha that the framebuffer stores and that every slice changes.
std::optional<std::string> read_front_to_back(const Factors& alpha, bool written, Blending& blending) {
  if (!written) return "the slices blend by a destination alpha that the framebuffer lacks or that is masked";
  blending.op = Operator::over;
  blending.premultiplied = true;
  const bool covers =
      alpha == Factors{GL_ONE_MINUS_DST_ALPHA, GL_ONE} || alpha == Factors{GL_ONE, GL_ONE_MINUS_SRC_ALPHA};
  if (blending.front_to_back == FrontToBack::room && covers) return std::nullopt;
  if (blending.front_to_back == FrontToBack::transparency &&
      alpha == Factors{GL_ZERO, GL_ONE_MINUS_SRC_ALPHA}) {
    return std::nullopt;
  }
  return "the slices blend front to back, but their alpha does not";
}

/// Returns whether fragments replace pixels, as in OpenGL's initial state.
bool replaces(GLint equation, const Factors& factors) {
  return equation == GL_FUNC_ADD && factors.source == GL_ONE && factors.destination == GL_ZERO;
}

std::optional<std::string> read_colour(GLint equation, const Factors& factors, Blending& blending) {
  if (const auto op = extremum(equation)) {
    blending.op = *op;
    blending.premultiplied = true;
    return std::nullopt;
  }
  if (equation != GL_FUNC_ADD) return "the blend equation is a subtraction";
  if (factors == Factors{GL_ONE_MINUS_DST_ALPHA, GL_ONE}) {
    blending.front_to_back = FrontToBack::room;
    return std::nullopt;
  }
  if (factors == Factors{GL_DST_ALPHA, GL_ONE}) {
    blending.front_to_back = FrontToBack::transparency;
    return std::nullopt;
  }
  blending.premultiplied = factors.source == GL_ONE;
  if (factors.source == GL_ONE || factors.source == GL_SRC_ALPHA) {
    if (factors.destination == GL_ONE_MINUS_SRC_ALPHA) {
      blending.op = Operator::over;
      return std::nullopt;
    }
    if (factors.destination == GL_ONE) {
      blending.op = Operator::add;
      return std::nullopt;
    }
  }
  return "the blend function is none of over, under and sum";
}

std::optional<std::string> read_alpha(GLint equation, const Factors& factors, Blending& blending) {
  AlphaBlending& alpha = blending.alpha;
  if (const auto op = extremum(equation)) {
    alpha.op = *op;
    return std::nullopt;
  }
  if (equation != GL_FUNC_ADD) return "the blend equation of alpha is a subtraction";
  if (factors == Factors{GL_ZERO, GL_ONE}) {
    alpha.untouched = true;
    return std::nullopt;
  }
  // d + (1 - d) s = s + (1 - s) d
  if (factors == Factors{GL_ONE, GL_ONE_MINUS_SRC_ALPHA} ||
      factors == Factors{GL_ONE_MINUS_DST_ALPHA, GL_ONE}) {
    alpha.op = Operator::over;
    return std::nullopt;
  }
  if (factors.source == GL_ONE || factors.source == GL_SRC_ALPHA) {
    alpha.squared = factors.source == GL_SRC_ALPHA;
    if (factors.destination == GL_ONE) {
      alpha.op = Operator::add;
      return std::nullopt;
    }
    // The sum of squares must be attenuated by the colour's own transparency.
    if (factors.destination == GL_ONE_MINUS_SRC_ALPHA && blending.op == Operator::over) {
      alpha.op = Operator::over;
      return std::nullopt;
    }
  }
  return "the blend function of alpha is neither over nor a sum";
}

}  // namespace

std::optional<std::string> read_blending(const DispatchTable& gl, const Target& target, Blending& blending) {
  const Factors colour{state_value(gl, GL_BLEND_SRC_RGB), state_value(gl, GL_BLEND_DST_RGB)};
  const Factors alpha{state_value(gl, GL_BLEND_SRC_ALPHA), state_value(gl, GL_BLEND_DST_ALPHA)};
  const GLint alpha_equation = state_value(gl, GL_BLEND_EQUATION_ALPHA);
  std::array<GLboolean, 4> mask{};
  gl.GetBooleanv(GL_COLOR_WRITEMASK, mask.data());
  const bool alpha_written = mask[3] && target.alpha_bits > 0;
  const GLint equation = state_value(gl, GL_BLEND_EQUATION_RGB);
  blending.replaces = !gl.IsEnabled(GL_BLEND) ||
                      (replaces(equation, colour) && (!alpha_written || replaces(alpha_equation, alpha)));
  if (blending.replaces) {
    blending.premultiplied = true;
    return std::nullopt;
  }
  if (auto reason = read_colour(equation, colour, blending)) return reason;
  if (blending.front_to_back != FrontToBack::no) {
    if (alpha_equation != GL_FUNC_ADD) return "the slices blend front to back, but their alpha does not";
    return read_front_to_back(alpha, alpha_written, blending);
  }
  if (alpha_written) return read_alpha(alpha_equation, alpha, blending);
  blending.alpha.untouched = true;
  return std::nullopt;
}

void append_fragment_operations(const DispatchTable& gl, std::vector<float>& values) {
  GLfloat reference = 0;
  gl.GetFloatv(GL_ALPHA_TEST_REF, &reference);
  values.insert(values.end(),
                {gl.IsEnabled(GL_ALPHA_TEST) ? 1.0F : 0.0F, float(state_value(gl, GL_ALPHA_TEST_FUNC)),
                 reference, float(state_value(gl, GL_CLAMP_FRAGMENT_COLOR))});
}

volume::Classification alpha_as_colour(const volume::Classification& classification,
                                       const AlphaBlending& alpha) {
  if (const auto* function = std::get_if<volume::TransferFunction>(&classification)) {
    volume::TransferFunction gathered = *function;
    for (volume::Rgba& entry : gathered.entries) {
      entry = {alpha.squared ? entry[3] * entry[3] : entry[3], 0, 0, entry[3]};
    }
    return gathered;
  }
  if (const auto* pairs = std::get_if<volume::PreIntegrationTable>(&classification)) {
    volume::PreIntegrationTable gathered = *pairs;
    for (volume::Rgba& entry : gathered.entries) entry = {entry[3], 0, 0, entry[3]};
    gathered.multiply_by_alpha = alpha.squared;
    return gathered;
  }
  volume::LinearMap map = std::get<volume::LinearMap>(classification);
  for (std::size_t column = 0; column < 4; ++column) map.matrix[column] = map.matrix[12 + column];
  map.multiply_by_alpha = alpha.squared;
  return map;
}

}  // namespace understudy::spu
