// SPDX-License-Identifier: Apache-2.0
// Analyses a program's shaders: sources in, facts out (facts.h). Needs no OpenGL context, and depends on no
// driver.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <variant>

#include "spu/volume/program/facts.h"

namespace understudy::spu::program {

using StageFinding = std::variant<StageFacts, Failure>;

/// A scalar of a uniform that is taken as a constant: branches that it decides are followed on one side only.
/// The facts hold as long as the uniform keeps this value.
struct KnownUniform {
  std::string name;  ///< as in Source::name
  int component = 0;
  double value = 0;
  bool operator==(const KnownUniform&) const = default;
};

/// Analyses GLSL 1.10 to 4.60 and ES 1.00 to 3.20; 1.10 if the source specifies no version. Several sources are
/// several shader objects of one stage, linked together. `extensions` are the driver's, for sources that test
/// them by `#ifdef`: without them such a source is refused. Only for sources that the driver has compiled: the
/// front end is not hardened against malicious ones. Thread-safe; the first call of a process initialises the
/// front end, the first with a version its built-in functions. Throws only std::bad_alloc.
StageFinding analyse(Stage stage, std::span<const std::string> sources,
                     std::span<const KnownUniform> known = {},
                     const std::optional<std::span<const std::string>>& extensions = std::nullopt);

/// Analyses programs in assembly language: "!!ARBfp1.0" and "!!ARBvp1.0".
StageFinding analyse_assembly(const std::string& source);

}  // namespace understudy::spu::program
