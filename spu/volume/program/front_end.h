// SPDX-License-Identifier: Apache-2.0
// The GLSL front end: glslang of the Khronos Group. Its symbols stay hidden in the library that links this one,
// because applications may contain a glslang of their own.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "spu/volume/program/facts.h"

class TIntermNode;

namespace understudy::spu::program {

/// The syntax tree of one stage, which lives as long as this object.
class ParsedStage {
 public:
  ParsedStage(ParsedStage&&) noexcept;
  ParsedStage& operator=(ParsedStage&&) noexcept;
  ~ParsedStage();

  const TIntermNode& root() const;
  int version() const;

 private:
  struct Held;
  explicit ParsedStage(std::unique_ptr<Held> held);
  std::unique_ptr<Held> held_;

  friend std::variant<ParsedStage, Failure> parse(
      Stage stage, std::span<const std::string> sources,
      const std::optional<std::span<const std::string>>& extensions);
};

/// For sources that test extensions, `extensions` decide (driver_macros.h). Initialises glslang in the first
/// call of a process, and never finalises it: other threads may be parsing while the process exits.
std::variant<ParsedStage, Failure> parse(Stage stage, std::span<const std::string> sources,
                                         const std::optional<std::span<const std::string>>& extensions);

}  // namespace understudy::spu::program
