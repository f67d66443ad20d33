// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/random_shading.h"

#include <vector>

namespace adversary {
namespace {

/// Writes expressions and statements. Each value is bounded and none is NaN, so that all drivers compute the
/// same.
class Writer {
 public:
  Writer(std::mt19937& chance, Dependence dependence, const ShadingPlace& place)
      : chance_(chance), place_(place), dependent_(dependence == Dependence::other_things) {}

  bool used_other_things() const { return used_other_things_; }

  std::string scalar(int depth) {
    if (dependent_ && one_in(7)) return other_thing();
    if (depth <= 0 || one_in(5)) return leaf();
    const std::string first = scalar(depth - 1);
    switch (below(13)) {
      case 0:
        return "(" + first + " + " + scalar(depth - 1) + ")";
      case 1:
        return "(" + first + " - " + scalar(depth - 1) + ")";
      case 2:
        return "(" + first + " * " + scalar(depth - 1) + ")";
      case 3:
        return "mix(" + first + ", " + scalar(depth - 1) + ", " + share() + ")";
      case 4:
        return "clamp(" + first + ", 0.0, " + number() + ")";
      case 5:
        return "smoothstep(0.1, 0.8, " + first + ")";
      case 6:
        return "max(" + first + ", " + scalar(depth - 1) + ")";
      case 7:
        return "abs(" + first + " - " + number() + ")";
      case 8:
        return "pow(abs(" + first + ") + 0.05, " + any({"0.5", "1.5", "2.0"}) + ")";
      case 9:
        return "(0.5 + 0.5 * sin(" + first + " * " + any({"2.0", "5.0", "9.0"}) + "))";
      case 10:
        return "(" + condition(depth - 1) + " ? " + first + " : " + scalar(depth - 1) + ")";
      case 11:
        return "curve[int(clamp(" + first + ", 0.0, 1.0) * 3.0)]";
      default:
        return "texture(table, vec2(" + first + ", 0.5))." + any({"r", "g", "b"});
    }
  }

  std::string block(int depth) {
    std::string text;
    for (unsigned i = 0; i < 1 + below(3); ++i) text += statement(depth);
    return text;
  }

  /// Returns a function of its argument and of uniforms that never change.
  static std::string function_of(Writer writer) {
    writer.dependent_ = false;
    writer.in_function_ = true;
    return "float ramp(float value) {\n  float f = value;\n  return " + writer.scalar(3) + ";\n}\n";
  }

 private:
  unsigned below(unsigned end) { return static_cast<unsigned>(chance_() % end); }
  bool one_in(unsigned n) { return below(n) == 0; }
  std::string any(const std::vector<std::string>& words) {
    return words[below(static_cast<unsigned>(words.size()))];
  }
  std::string number() { return any({"0.125", "0.25", "0.4", "0.5", "0.75", "1.0"}); }
  /// An expression from 0 to 1.
  std::string share() { return "clamp(" + leaf() + ", 0.0, 1.0)"; }

  std::string leaf() {
    if (in_function_) return any({"value", "value", "f", "level", "curve[1]", number()});
    return any({"value", "value", "value", "f", "f", "colour.r", "colour.g", "colour.b", "colour.a", "level",
                "curve[2]", "ramp(value)", number()});
  }

  std::string other_thing() {
    used_other_things_ = true;
    const std::string at = place_.position;
    std::vector<std::string> things{at + ".x",
                                    at + ".y",
                                    at + ".z",
                                    "length(" + at + " - vec3(0.5))",
                                    "gl_FragCoord.x / 256.0",
                                    "gl_FragCoord.y / 256.0",
                                    "moment",
                                    "texture(volume, " + at + " + vec3(0.05, 0.0, 0.0)).r",
                                    "texture(volume, " + at + ".zxy).r",
                                    "texture(table, gl_FragCoord.xy / 256.0).g"};
    if (place_.counter.empty())
      things.insert(things.end(), {"clamp(abs(dFdx(value)) * 8.0, 0.0, 1.0)", "(gl_FrontFacing ? 1.0 : 0.3)",
                                   "fract(float(gl_PrimitiveID) * 0.37)"});
    else
      things.insert(things.end(), {"fract(float(" + place_.counter + ") * 0.1)", "sum.a"});
    return any(things);
  }

  std::string condition(int depth) {
    if (depth > 0 && one_in(4))
      return "(" + condition(depth - 1) + any({" && ", " || "}) + condition(depth - 1) + ")";
    return "(" + scalar(depth - 1) + any({" > ", " < "}) + number() + ")";
  }

  std::string assignment() {
    const std::string target = any({"f", "f", "colour.r", "colour.g", "colour.b", "colour.a"});
    if (one_in(6)) return "colour.rgb = mix(colour.rgb, vec3(" + scalar(2) + "), " + number() + ");\n";
    return target + " = clamp(" + scalar(3) + ", 0.0, 1.0);\n";
  }

  std::string loop(int depth) {
    const std::string counter = "n" + std::to_string(counters_++);
    return "for (int " + counter + " = 0; " + counter + " < 3; ++" + counter + ") {\n" + block(depth - 1) +
           "if (f > 0.9) break;\n}\n";
  }

  std::string statement(int depth) {
    if (depth <= 0 || one_in(2)) return assignment();
    switch (below(6)) {
      case 0:
        return loop(depth);
      case 1:
        return "if (" + condition(1) + ") " + place_.skip + ";\n";
      case 2:
        return "if (" + condition(2) + ") {\n" + block(depth - 1) + "} else {\n" + block(depth - 1) + "}\n";
      default:
        return "if (" + condition(2) + ") {\n" + block(depth - 1) + "}\n";
    }
  }

  std::mt19937& chance_;
  const ShadingPlace& place_;
  bool dependent_;
  bool in_function_ = false;
  bool used_other_things_ = false;
  int counters_ = 0;
};

}  // namespace

RandomShading random_shading(std::mt19937& chance, Dependence dependence, const ShadingPlace& place) {
  while (true) {
    Writer writer(chance, dependence, place);
    RandomShading shading;
    shading.declarations =
        "uniform float level;\nuniform float curve[4];\nuniform float moment;\n" + Writer::function_of(writer);
    shading.body = "float f = value;\n" + writer.block(2) + writer.block(2) +
                   "colour = vec4(clamp(colour.rgb, 0.0, 1.0), 0.15 * clamp(colour.a + 0.2, 0.0, 1.0));\n";
    if (dependence == Dependence::sample_alone || writer.used_other_things()) return shading;
  }
}

}  // namespace adversary
