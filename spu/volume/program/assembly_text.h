// SPDX-License-Identifier: Apache-2.0
// The text of programs in assembly language (ARB_vertex_program, ARB_fragment_program), cut into instructions.
#pragma once

#include <string>
#include <vector>

namespace understudy::spu::program {

/// "MUL_SAT colour.xyz, value.x, table.wzyx" or a declaration, "TEMP value, colour".
struct Instruction {
  std::string name;                   ///< without _SAT
  std::vector<std::string> operands;  ///< as they are written, without blanks; of declarations all that follows
  int line = 0;
};

/// Without comments, from behind the head ("!!ARBfp1.0") to END.
std::vector<Instruction> instructions_of(const std::string& text);

/// Of an operand: "-table.wzyx" and the like.
struct Operand {
  std::string name;     ///< "fragment.texcoord[0]", "value", "{1,2,3,4}", "0.5"
  std::string swizzle;  ///< x, y, z and w, one or four of them; of what is written to the mask; empty: all
  bool negative = false;
};

Operand operand_of(const std::string& text);

}  // namespace understudy::spu::program
