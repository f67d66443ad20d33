// SPDX-License-Identifier: Apache-2.0
#include "tests/spu/program/random_shader.h"

#include <array>

#include "tests/spu/program/shader_facts.h"

namespace understudy::spu::program::testing {
namespace {

template <std::size_t n>
std::string any(std::mt19937& chance, const std::array<const char*, n>& list) {
  return list[chance() % n];
}

/// Locals of every function, in addition to f and p, which are parameters of some.
constexpr const char* locals =
    "float g = 0.25; vec4 q = vec4(0.2); float s[3] = float[3](0.1, 0.2, 0.3);\n"
    "Pair r = Pair(vec2(0.3), 0.4); mat2 m = mat2(1.0);\n";

}  // namespace

std::string RandomShader::number() {
  return any(chance_, std::array{"0.0", "0.125", "0.5", "0.75", "1.0", "-0.25", "2.0"});
}

std::string RandomShader::integer() {
  return any(chance_, std::array{"(k & 1)", "int(abs(f) * 7.0) % 3", "int(abs(p.x) * 5.0) % 3", "0", "1", "2",
                                 "((k + 1) & 1)"});
}

std::string RandomShader::scalar(int depth) {
  if (depth <= 0 || one_in(4))
    return any(chance_,
               std::array{"f",    "g",        "p.x",      "p.y",     "q.z",     "q.w",     "s[0]", "s[1]",
                          "s[2]", "r.pair.x", "r.pair.y", "r.one",   "m[0][1]", "m[1][0]", "a.x",  "a.y",
                          "a.z",  "a.w",      "b.x",      "b.y",     "b.z",     "b.w",     "u.x",  "u.y",
                          "u.z",  "u.w",      "list[0]",  "list[3]", "kept"});
  switch (below(13)) {
    case 0:
      return "(" + scalar(depth - 1) + " + " + scalar(depth - 1) + ")";
    case 1:
      return "(" + scalar(depth - 1) + " * " + scalar(depth - 1) + ")";
    case 2:
      return "(" + condition(depth - 1) + " ? " + scalar(depth - 1) + " : " + scalar(depth - 1) + ")";
    case 3:
      return "dot(" + vector(depth - 1) + ".yz, " + vector(depth - 1) + ".xw)";
    case 4:
      return "list[" + integer() + "]";
    case 5:
      return "s[" + integer() + "]";
    case 6:
      return vector(depth - 1) + "[" + integer() + "]";
    case 7:
      return "texture(table, " + scalar(depth - 1) + ")." + any(chance_, std::array{"x", "y", "w"});
    case 8:
      return "texture(volume, " + vector(depth - 1) + ".zxy)." + any(chance_, std::array{"x", "z", "w"});
    case 9:
      return "(m * " + vector(depth - 1) + ".xy)." + any(chance_, std::array{"x", "y"});
    case 10:
      return "clamp(" + scalar(depth - 1) + ", -1.0, " + number() + " + 2.0)";
    case 11:
      return functions_ == 0
                 ? number()
                 : "call" + std::to_string(below(unsigned(functions_))) + "(p, s[" + integer() + "])";
    default:
      return number();
  }
}

std::string RandomShader::vector(int depth) {
  if (depth <= 0 || one_in(3))
    return any(chance_, std::array{"p", "q", "a", "b", "u", "p.wzyx", "q.xxzz", "b.yxwz"});
  switch (below(5)) {
    case 0:
      return "(" + vector(depth - 1) + " + " + vector(depth - 1) + ")";
    case 1:
      return "vec4(" + scalar(depth - 1) + ", " + vector(depth - 1) + ".yzw)";
    case 2:
      return "mix(" + vector(depth - 1) + ", " + vector(depth - 1) + ", " + scalar(depth - 1) + ")";
    case 3:
      return "vec4(m[1], r.pair)";
    default:
      return "vec4(cross(" + vector(depth - 1) + ".xyz, " + vector(depth - 1) + ".yzw), " + scalar(depth - 1) +
             ")";
  }
}

std::string RandomShader::condition(int depth) {
  switch (below(depth <= 0 ? 2 : 5)) {
    case 0:
      return "(" + scalar(depth - 1) + " > " + number() + ")";
    case 1:
      return "(k == " + std::to_string(below(3)) + ")";
    case 2:
      return "(" + condition(depth - 1) + " && " + condition(depth - 1) + ")";
    case 3:
      return "any(greaterThan(" + vector(depth - 1) + ".xy, " + vector(depth - 1) + ".zw))";
    default:
      return "!(" + condition(depth - 1) + " || (f = " + scalar(depth - 1) + ") < 0.3)";
  }
}

std::string RandomShader::assignment() {
  const std::string target = any(
      chance_, std::array{"f", "g", "p.x", "p.zw", "q", "q.yx", "s[0]", "s[INDEX]", "r.one", "r.pair.y", "r",
                          "m[1]", "m[INDEX1].x", "p[INDEX]", "kept", "colour.x", "colour.yz", "colour"});
  std::string place = target;
  if (const std::size_t at = place.find("INDEX1"); at != std::string::npos) place.replace(at, 6, "(k & 1)");
  if (const std::size_t at = place.find("INDEX"); at != std::string::npos) place.replace(at, 5, integer());
  const std::string how = one_in(4) ? " += " : " = ";
  if (target == "q" || target == "colour") return place + how + vector(3) + ";\n";
  if (target == "r") return "r = Pair(" + vector(2) + ".xz, " + scalar(2) + ");\n";
  if (target == "p.zw" || target == "q.yx" || target == "m[1]" || target == "colour.yz")
    return place + how + vector(3) + ".wx;\n";
  return place + how + scalar(3) + ";\n";
}

std::string RandomShader::way_out() {
  if (loops_ > 0 && one_in(2)) return one_in(2) ? "break;\n" : "continue;\n";
  if (!in_main_) return "return " + scalar(2) + ";\n";
  return one_in(2) ? "discard;\n" : "return;\n";
}

std::string RandomShader::branch(int depth) {
  std::string text = "if (" + condition(2) + ") {\n" + block(depth - 1);
  if (one_in(4)) text += way_out();
  text += "}";
  if (one_in(2)) text += " else {\n" + block(depth - 1) + "}";
  return text + "\n";
}

std::string RandomShader::loop(int depth) {
  const std::string counter = "i" + std::to_string(counters_++);
  const std::string more = one_in(3) ? " && " + condition(1) : "";
  ++loops_;
  const std::string body = block(depth - 1);
  --loops_;
  if (one_in(3))
    return "{ int " + counter + " = 0; do {\n" + body + "} while (++" + counter + " < 3" + more + "); }\n";
  const std::string end = one_in(2) ? "3" : "(k & 3)";
  return "for (int " + counter + " = 0; " + counter + " < " + end + more + "; ++" + counter + ") {\n" + body +
         "}\n";
}

std::string RandomShader::choice(int depth) {
  std::string text = "switch (" + integer() + ") {\n";
  for (int label = 0; label < 2; ++label) {
    text += "case " + std::to_string(label) + ":\n" + block(depth - 1);
    if (one_in(3)) text += "if (" + condition(1) + ") break;\n" + statement(0);
    if (!one_in(3)) text += "break;\n";
  }
  if (one_in(2)) text += "default:\n" + block(depth - 1);
  return text + "}\n";
}

std::string RandomShader::statement(int depth) {
  if (depth <= 0 || one_in(2)) return assignment();
  switch (below(5)) {
    case 0:
      return loop(depth);
    case 1:
      return choice(depth);
    default:
      return branch(depth);
  }
}

std::string RandomShader::block(int depth) {
  std::string text;
  for (unsigned i = 0; i <= below(3); ++i) text += statement(depth);
  return text;
}

std::string RandomShader::function(const std::string& name) {
  return "float " + name + "(inout vec4 p, float f) {\n" + locals + block(2) + "return " + scalar(2) + ";\n}\n";
}

std::string RandomShader::text() {
  std::string before = "struct Pair { vec2 pair; float one; };\nfloat kept = 0.5;\n";
  in_main_ = false;
  for (int i = 0; i < 2; ++i) {
    before += function("call" + std::to_string(i));
    functions_ = i + 1;
  }
  in_main_ = true;
  std::string body = "float f = 0.5; vec4 p = vec4(0.1);\n" + std::string(locals) + "colour = vec4(0.0);\n" +
                     block(3) + block(3) + assignment();
  return shader(body, before);
}

}  // namespace understudy::spu::program::testing
