// SPDX-License-Identifier: Apache-2.0
// Finds expressions that change variables while they are evaluated. GLSL leaves undefined in which order the
// operands around them are read.
#pragma once

#include <glslang/Include/intermediate.h>

#include <unordered_map>
#include <vector>

#include "spu/volume/program/variables.h"

namespace understudy::spu::program {

class Effects {
 public:
  explicit Effects(const Variables& variables) : variables_(variables) {}

  /// Returns whether evaluating `node` writes to anything but local variables of the functions that it calls.
  bool has(const TIntermNode* node);

 private:
  std::vector<const TIntermNode*> written_by(const glslang::TIntermAggregate& call) const;
  bool of_call(const glslang::TIntermAggregate& call);
  bool of_function(const Function& function);
  /// Returns whether what is written at `target` outlives a call of `function`.
  bool outlasts(const TIntermNode* target, const Function& function) const;
  /// Returns whether a statement of `function` writes to what outlives its call.
  bool reaches_out(const TIntermNode* node, const Function& function);

  const Variables& variables_;
  std::unordered_map<const TIntermNode*, bool> known_;
  std::unordered_map<const Function*, bool> functions_;
};

}  // namespace understudy::spu::program
