// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program/analysis.h"

#include <exception>
#include <new>

#include "spu/volume/program/front_end.h"
#include "spu/volume/program/walk.h"

namespace understudy::spu::program {
namespace {

StageFinding walked(Stage stage, const ParsedStage& parsed, std::span<const KnownUniform> known) {
  const Variables variables(stage, parsed.root());
  Walk walk(stage, variables);
  for (const KnownUniform& uniform : known) walk.assume(uniform.name, uniform.component, uniform.value);
  return walk.facts(parsed.root(), parsed.version());
}

}  // namespace

StageFinding analyse(Stage stage, std::span<const std::string> sources, std::span<const KnownUniform> known,
                     const std::optional<std::span<const std::string>>& extensions) try {
  const auto parsed = parse(stage, sources, extensions);
  if (const auto* failure = std::get_if<Failure>(&parsed)) return *failure;
  return walked(stage, std::get<ParsedStage>(parsed), known);
} catch (const TooLarge&) {
  return Failure{Failure::Kind::too_large, "the shader is too large to follow"};
} catch (const NoMain&) {
  return Failure{Failure::Kind::parse, "the shader has no main function"};
} catch (const NotFollowed& found) {
  return Failure{Failure::Kind::unsupported, found.what};
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception& error) {
  return Failure{Failure::Kind::unsupported, std::string("the shader cannot be followed: ") + error.what()};
}

}  // namespace understudy::spu::program
