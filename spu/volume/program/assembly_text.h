// SPDX-License-Identifier: Apache-2.0
// Splits the text of programs in assembly language (ARB_vertex_program, ARB_fragment_program) into
// instructions.
#pragma once

#include <string>
#include <vector>

namespace understudy::spu::program {

/// "MUL_SAT colour.xyz, value.x, table.wzyx" or a declaration, "TEMP value, colour".
struct Instruction {
  std::string name;                   ///< without _SAT
  bool saturates = false;             ///< with _SAT: the result is clamped to [0,1]
  std::vector<std::string> operands;  ///< as written, without blanks; of declarations, all that follows
  int line = 0;
};

/// Returns the instructions between the header ("!!ARBfp1.0") and END, without comments.
std::vector<Instruction> instructions_of(const std::string& text);

/// The parts of an operand such as "-table.wzyx".
struct Operand {
  std::string name;     ///< "fragment.texcoord[0]", "value", "{1,2,3,4}", "0.5"
  std::string swizzle;  ///< x, y, z and w, one or four of them; of a target, those written; empty: all
  bool negative = false;
};

Operand operand_of(const std::string& text);

}  // namespace understudy::spu::program
