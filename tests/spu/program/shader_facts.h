// SPDX-License-Identifier: Apache-2.0
// Facts in a form that tests can compare.
#pragma once

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "spu/volume/program/analysis.h"

namespace understudy::spu::program::testing {

using Texts = std::set<std::string>;

/// Facts of one source; a failed analysis fails the test.
inline StageFacts facts_of(const std::string& source, Stage stage = Stage::fragment,
                           const std::vector<KnownUniform>& known = {}) {
  const std::vector<std::string> sources{source};
  StageFinding finding = analyse(stage, sources, known);
  if (const auto* failure = std::get_if<Failure>(&finding)) {
    ADD_FAILURE() << failure->what << " in\n" << source;
    return {};
  }
  return std::get<StageFacts>(std::move(finding));
}

inline std::string what_fails(const std::string& source, Stage stage = Stage::fragment) {
  const std::vector<std::string> sources{source};
  const StageFinding finding = analyse(stage, sources);
  const auto* failure = std::get_if<Failure>(&finding);
  return failure == nullptr ? "" : failure->what;
}

/// "varying tc.z", "uniform time (branch)", "texel of 'volume'.x (loop)".
inline Texts texts_of(const StageFacts& facts, const Dependences& dependences) {
  Texts texts;
  for (const Dependence& dependence : dependences) {
    std::string words = text(facts.sources[dependence.source]);
    if (dependence.flow == Flow::branch) words += " (branch)";
    if (dependence.flow == Flow::loop) words += " (loop)";
    texts.insert(words);
  }
  return texts;
}

/// The sources that a component of an output depends on.
inline Texts reaches(const StageFacts& facts, const std::string& name, int component = 0) {
  for (const Output& output : facts.outputs) {
    if (output.name == name && output.component == component)
      return output.written ? texts_of(facts, output.on) : Texts{"not written"};
  }
  return {"no such output"};
}

/// A shader with `body` in main, which writes `colour`. Inputs a (vec4) and b (vec4), uniforms u (vec4), k
/// (int), list (float[4]), samplers volume (3-D) and table (1-D); `before` precedes main.
inline std::string shader(const std::string& body, const std::string& before = "") {
  return "#version 330\n"
         "in vec4 a, b; uniform vec4 u; uniform int k; uniform float list[4];\n"
         "uniform sampler3D volume; uniform sampler1D table;\n"
         "out vec4 colour;\n" +
         before + "\nvoid main() {\n" + body + "\n}\n";
}

/// The sources that component `component` of `colour` depends on after `body`.
inline Texts colour_of(const std::string& body, int component = 0, const std::string& before = "") {
  return reaches(facts_of(shader(body, before)), "colour", component);
}

}  // namespace understudy::spu::program::testing
