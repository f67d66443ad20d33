// SPDX-License-Identifier: Apache-2.0
// Random fragment shaders: every construct that values can pass through, in any order.
#pragma once

#include <random>
#include <string>

namespace understudy::spu::program::testing {

/// Has the inputs of shader() in shader_facts.h. Every loop ends, and every index is inside its array.
class RandomShader {
 public:
  explicit RandomShader(unsigned seed) : chance_(seed) {}

  std::string text();

 private:
  unsigned below(unsigned end) { return unsigned(chance_() % end); }
  bool one_in(unsigned n) { return below(n) == 0; }

  std::string number();
  std::string scalar(int depth);
  std::string vector(int depth);
  std::string condition(int depth);
  std::string integer();
  std::string assignment();
  std::string statement(int depth);
  std::string block(int depth);
  std::string branch(int depth);
  std::string loop(int depth);
  std::string choice(int depth);
  std::string way_out();
  std::string function(const std::string& name);

  std::mt19937 chance_;
  int loops_ = 0;     ///< loops around the current statement
  int counters_ = 0;  ///< number declared so far
  bool in_main_ = true;
  int functions_ = 0;  ///< number that can be called
};

}  // namespace understudy::spu::program::testing
