// SPDX-License-Identifier: Apache-2.0
// Which expressions change variables while they are evaluated. GLSL leaves open in which order the operands
// around them are read.
#pragma once

#include <glslang/Include/intermediate.h>

#include <unordered_map>
#include <vector>

#include "spu/volume/program/variables.h"

namespace understudy::spu::program {

class Effects {
 public:
  explicit Effects(const Variables& variables) : variables_(variables) {}

  /// Whether evaluating `node` writes to anything but variables that the functions it calls begin anew.
  bool has(const TIntermNode* node);

 private:
  std::vector<const TIntermNode*> written_by(const glslang::TIntermAggregate& call) const;
  bool of_call(const glslang::TIntermAggregate& call);
  bool of_function(const Function& function);
  /// Whether what is written at `target` outlasts a call of `function`.
  bool outlasts(const TIntermNode* target, const Function& function) const;
  /// Whether a statement of `function` writes to what outlasts its call.
  bool reaches_out(const TIntermNode* node, const Function& function);

  const Variables& variables_;
  std::unordered_map<const TIntermNode*, bool> known_;
  std::unordered_map<const Function*, bool> functions_;
};

}  // namespace understudy::spu::program
