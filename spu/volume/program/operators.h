// SPDX-License-Identifier: Apache-2.0
// How the components of an operator's result depend on those of its operands.
#pragma once

#include <glslang/Include/intermediate.h>

namespace understudy::spu::program {

enum class Pattern {
  componentwise,  ///< component i of each operand, or its only one
  mixed,          ///< every component of every operand
  matrix_vector,
  vector_matrix,
  matrix_matrix,
  transposed,
  outer_product,
  cross_product,
};

/// `mixed` for all unknown operators, which is safe for every pure function.
Pattern pattern_of(glslang::TOperator op);

/// The operator that a compound assignment applies before it assigns; EOpNull for plain and for no assignment.
glslang::TOperator operator_of_assignment(glslang::TOperator op);

bool is_derivative(glslang::TOperator op);
bool is_increment(glslang::TOperator op);

/// Returns whether a built-in function writes to its parameter `i`.
bool writes_parameter(glslang::TOperator op, std::size_t i);

}  // namespace understudy::spu::program
