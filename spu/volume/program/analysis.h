// SPDX-License-Identifier: Apache-2.0
// Reads a program's shaders: sources in, facts out (facts.h). Needs no OpenGL context, and knows no driver.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <variant>

#include "spu/volume/program/facts.h"

namespace understudy::spu::program {

using StageFinding = std::variant<StageFacts, Failure>;

/// A uniform's number, taken for a constant: branches that it decides are followed on one side. What is found
/// holds as long as the uniform keeps it.
struct KnownUniform {
  std::string name;  ///< as in Source::name
  int component = 0;
  double value = 0;
  bool operator==(const KnownUniform&) const = default;
};

/// GLSL 1.10 to 4.60 and ES 1.00 to 3.20; 1.10 where the text does not say. Several sources are several shader
/// objects of one stage, linked together. `extensions` are the driver's, for texts that ask for them by
/// `#ifdef`: without them such a text is refused. Only for what the driver has compiled: the front end is not
/// meant for texts that are made to break it. Safe from any thread; the first call of a process initialises the
/// front end, the first with a version its built-in functions. Throws std::bad_alloc
/// alone.
StageFinding analyse(Stage stage, std::span<const std::string> sources,
                     std::span<const KnownUniform> known = {},
                     const std::optional<std::span<const std::string>>& extensions = std::nullopt);

/// Programs in assembly language: "!!ARBfp1.0" and "!!ARBvp1.0".
StageFinding analyse_assembly(const std::string& source);

}  // namespace understudy::spu::program
