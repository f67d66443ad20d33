// SPDX-License-Identifier: Apache-2.0
// Programs in assembly language: a sequence of instructions without branches, so one walk over them is enough.
#include <algorithm>
#include <array>
#include <map>
#include <new>
#include <optional>
#include <set>
#include <utility>

#include "spu/volume/program/analysis.h"
#include "spu/volume/program/assembly_text.h"
#include "spu/volume/program/values.h"

namespace understudy::spu::program {
namespace {

struct Unsupported {
  std::string what;
};

constexpr std::string_view letters = "xyzw";
/// Smaller numbers are operators of the front end.
constexpr std::uint32_t first_operator = 1U << 21U;

/// Returns the longest of the names that a binding has.
std::string full_name(const std::string& name) {
  if (name == "fragment.color") return "fragment.color.primary";
  if (name == "fragment.texcoord" || name == "texture") return name + "[0]";
  return name;
}

bool is_number(const std::string& text) {
  const std::size_t sign = text.starts_with('-') || text.starts_with('+') ? 1 : 0;
  return text.size() > sign && (text[sign] == '.' || std::isdigit(static_cast<unsigned char>(text[sign])) != 0);
}

SourceKind kind_of_binding(const std::string& binding) {
  if (binding.starts_with("fragment.position")) return SourceKind::fragment_coordinate;
  if (binding.starts_with("fragment.facing")) return SourceKind::front_facing;
  if (binding.starts_with("fragment.")) return SourceKind::varying;
  if (binding.starts_with("vertex.")) return SourceKind::attribute;
  return SourceKind::uniform;
}

TextureShape shape_of(const std::string& target) {
  static const std::map<std::string, TextureShape> shapes{{"1D", TextureShape::line},
                                                          {"2D", TextureShape::plane},
                                                          {"3D", TextureShape::space},
                                                          {"CUBE", TextureShape::cube},
                                                          {"RECT", TextureShape::rectangle}};
  const std::string name = target.starts_with("SHADOW") ? target.substr(6) : target;
  const auto found = shapes.find(name);
  return found == shapes.end() ? TextureShape::other : found->second;
}

std::size_t dimensions_of(TextureShape shape) {
  if (shape == TextureShape::line) return 1;
  return shape == TextureShape::plane || shape == TextureShape::rectangle ? 2 : 3;
}

/// Which components of the operands a component of the result depends on.
enum class Shape { each, first, three, four, all, cross };

std::optional<Shape> shape_of_instruction(const std::string& name) {
  static const std::map<std::string, Shape> shapes{
      {"ABS", Shape::each},  {"ADD", Shape::each},  {"CMP", Shape::each},  {"FLR", Shape::each},
      {"FRC", Shape::each},  {"LRP", Shape::each},  {"MAD", Shape::each},  {"MAX", Shape::each},
      {"MIN", Shape::each},  {"MOV", Shape::each},  {"MUL", Shape::each},  {"SGE", Shape::each},
      {"SLT", Shape::each},  {"SUB", Shape::each},  {"ARL", Shape::each},  {"COS", Shape::first},
      {"EX2", Shape::first}, {"LG2", Shape::first}, {"POW", Shape::first}, {"RCP", Shape::first},
      {"RSQ", Shape::first}, {"SIN", Shape::first}, {"SCS", Shape::first}, {"EXP", Shape::first},
      {"LOG", Shape::first}, {"DP3", Shape::three}, {"DP4", Shape::four},  {"DPH", Shape::all},
      {"DST", Shape::all},   {"LIT", Shape::all},   {"XPD", Shape::cross}};
  const auto found = shapes.find(name);
  if (found == shapes.end()) return std::nullopt;
  return found->second;
}

class AssemblyWalk {
 public:
  StageFacts facts(const std::string& text) {
    for (const Instruction& instruction : instructions_of(text)) execute(instruction);
    add_fog();
    return exported();
  }

 private:
  using Set = Values::Set;

  void execute(const Instruction& instruction) {
    const std::string& name = instruction.name;
    if (std::ranges::any_of(instruction.operands, &std::string::empty))
      throw Unsupported{"instruction " + name + " with an empty operand"};
    if (name == "OPTION") return choose(instruction.operands.at(0));
    if (name == "TEMP" || name == "ADDRESS") return;
    if (name == "ATTRIB" || name == "PARAM" || name == "OUTPUT" || name == "ALIAS")
      return declare(instruction.operands);
    if (name == "KIL") return discard(instruction);
    if (name == "TEX" || name == "TXP" || name == "TXB") return fetch(instruction);
    if (name == "SWZ") return swizzle(instruction);
    compute(instruction);
  }

  void choose(const std::string& option) {
    static const std::set<std::string> harmless{
        "ARB_precision_hint_fastest", "ARB_precision_hint_nicest",   "ARB_draw_buffers",
        "ATI_draw_buffers",           "ARB_fragment_program_shadow", "ARB_position_invariant"};
    if (option.starts_with("ARB_fog_"))
      fog_ = true;
    else if (!harmless.contains(option))
      throw Unsupported{"OPTION " + option};
  }

  /// "name=binding" or "name[4]={...}", without blanks.
  void declare(const std::vector<std::string>& operands) {
    const std::string& text = operands.at(0);
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) throw Unsupported{"declaration " + text};
    const std::string name = text.substr(0, std::min(equals, text.find('[')));
    const std::string binding = text.substr(equals + 1);
    if (text.find('[') < equals)
      arrays_[name] = elements_of(binding);
    else
      bindings_[name] = binding;
  }

  /// Returns the elements of "{program.env[0..3],state.matrix.mvp}": ranges are expanded, matrices to their
  /// rows.
  static std::vector<std::string> elements_of(const std::string& list) {
    std::vector<std::string> elements;
    std::string current;
    int depth = 0;
    for (const char letter : list) {
      if (letter == '{' && depth++ == 0) continue;
      if (letter == '}' && --depth == 0) break;
      if (letter == ',' && depth == 1)
        add_range(elements, std::exchange(current, {}));
      else
        current += letter;
    }
    add_range(elements, current);
    return elements;
  }

  static void add_range(std::vector<std::string>& elements, const std::string& binding) {
    const std::size_t dots = binding.find("..");
    const std::size_t bracket = binding.rfind('[', dots);
    if (dots == std::string::npos || bracket == std::string::npos) {
      if (!binding.starts_with("state.matrix.") || binding.find(".row[") != std::string::npos)
        return elements.push_back(binding);
      for (int row = 0; row < 4; ++row) elements.push_back(binding + ".row[" + std::to_string(row) + "]");
      return;
    }
    const int last = std::stoi(binding.substr(dots + 2));
    const int first = std::stoi(binding.substr(bracket + 1));
    if (last - first > 4096) throw TooLarge();
    for (int i = first; i <= last; ++i)
      elements.push_back(binding.substr(0, bracket) + "[" + std::to_string(i) + "]");
  }

  /// Resolves aliases and declared names to a register or its binding.
  std::string resolved(std::string name) const {
    const std::size_t bracket = name.find('[');
    const auto array = arrays_.find(name.substr(0, bracket));
    if (bracket != std::string::npos && array != arrays_.end()) {
      const bool known = std::isdigit(static_cast<unsigned char>(name[bracket + 1])) != 0;
      const std::size_t index = known ? std::stoul(name.substr(bracket + 1)) : array->second.size();
      return index < array->second.size() ? full_name(array->second[index]) : array->first + "[*]";
    }
    for (int hops = 0; hops < 8; ++hops) {
      const auto bound = bindings_.find(name);
      if (bound == bindings_.end()) break;
      name = bound->second;
    }
    return full_name(name);
  }

  Value read(const std::string& text) {
    Operand operand = operand_of(text);
    const Value whole = read_register(resolved(operand.name));
    Value value;
    for (std::size_t i = 0; i < 4; ++i) {
      const char letter =
          operand.swizzle.empty() ? letters[i] : operand.swizzle[std::min(i, operand.swizzle.size() - 1)];
      const Scalar scalar = whole[letters.find(letter)];
      value.push_back(operand.negative ? values_.combine(ValueNumbers::component, std::array{scalar}) : scalar);
    }
    return value;
  }

  Value read_register(const std::string& name) {
    const auto written = registers_.find(name);
    if (written != registers_.end()) return written->second;
    if (name.starts_with('{') || is_number(name)) return constants(name);
    Value value;
    const bool bound = name.find('.') != std::string::npos || name.ends_with(']');
    const SourceKind kind = bound ? kind_of_binding(name) : SourceKind::undefined;
    for (int i = 0; i < 4; ++i)
      value.push_back(source({.kind = kind, .name = name, .component = i, .components = 4, .rows = 4}));
    return registers_[name] = value;
  }

  Value constants(const std::string& text) {
    Value value = values_.zeros(4);
    value[3] = values_.constant(1);
    if (!text.starts_with('{')) return Value(4, values_.constant(std::stod(text)));
    const std::vector<std::string> numbers = elements_of(text);
    for (std::size_t i = 0; i < numbers.size() && i < 4; ++i)
      value[i] = values_.constant(std::stod(numbers[i]));
    return value;
  }

  Scalar source(Source described) {
    const std::uint32_t number = std::uint32_t(facts_.sources.size());
    facts_.sources.push_back(std::move(described));
    const Scalar scalar{values_.sets.single(number), values_.numbers.of(ValueNumbers::distinct, {number})};
    exact_[scalar.number] = number;
    return scalar;
  }

  /// Writes the result to the first operand. A clamped value is another than the one that was clamped.
  void write(const Instruction& instruction, Value value) {
    if (instruction.saturates) value = values_.componentwise(number_of("_SAT"), 4, std::array{value}, false);
    const Operand target = operand_of(instruction.operands.at(0));
    const std::string name = resolved(target.name);
    Value whole = read_register(name);
    for (std::size_t i = 0; i < 4; ++i) {
      if (!target.swizzle.empty() && target.swizzle.find(letters[i]) == std::string::npos) continue;
      whole[i] = value[i];
      if (name.starts_with("result.")) written_[name][i] = true;
    }
    registers_[name] = whole;
  }

  void compute(const Instruction& instruction) {
    const auto shape = shape_of_instruction(instruction.name);
    if (!shape) throw Unsupported{"instruction " + instruction.name};
    std::vector<Value> operands;
    for (std::size_t i = 1; i < instruction.operands.size(); ++i)
      operands.push_back(read(instruction.operands[i]));
    if (operands.empty()) throw Unsupported{"instruction " + instruction.name + " without operands"};
    write(instruction, result(instruction.name, *shape, operands));
  }

  Value result(const std::string& name, Shape shape, std::vector<Value> operands) {
    if (name == "MOV") return operands[0];
    const std::uint32_t op = number_of(name);
    switch (shape) {
      case Shape::each:
        return values_.componentwise(op, 4, operands, false);
      case Shape::cross: {
        Value value = values_.cross_product(op, operands[0], operands.at(1));
        value.push_back(values_.constant(0));
        return value;
      }
      case Shape::first:
        for (Value& operand : operands) operand.resize(1);
        break;
      case Shape::three:
        for (Value& operand : operands) operand.resize(3);
        break;
      case Shape::four:
      case Shape::all:
        break;
    }
    return values_.mixed(op, 4, operands);
  }

  std::uint32_t number_of(const std::string& name) {
    return operators_.emplace(name, first_operator + std::uint32_t(operators_.size())).first->second;
  }

  void swizzle(const Instruction& instruction) {
    const std::vector<std::string>& operands = instruction.operands;
    const Value whole = read(operands.at(1));
    Value value;
    for (std::size_t i = 2; i < operands.size(); ++i) {
      const char letter = operands[i].back();
      const std::size_t component = std::string_view("xyzwrgba").find(letter);
      value.push_back(component == std::string_view::npos ? values_.constant(letter == '1' ? 1 : 0)
                                                          : whole[component % 4]);
      if (operands[i].starts_with('-'))
        value.back() = values_.combine(ValueNumbers::component, std::array{value.back()});
    }
    value.resize(4);
    write(instruction, value);
  }

  void discard(const Instruction& instruction) {
    const Set on = values_.union_of(read(instruction.operands.at(0)));
    facts_.discards.push_back(
        {.line = instruction.line, .on = values_.sets.members(values_.sets.by(Flow::branch, on))});
  }

  void fetch(const Instruction& instruction) {
    const Value coordinate = read(instruction.operands.at(1));
    const std::string& target = instruction.operands.at(3);
    Fetch fetch{.sampler = resolved(instruction.operands.at(2)), .line = instruction.line};
    fetch.type = {.shape = shape_of(target), .shadow = target.starts_with("SHADOW")};
    fetch.projected = instruction.name == "TXP";
    fetch.bias = instruction.name == "TXB";
    const std::size_t dimensions = dimensions_of(fetch.type.shape);
    for (std::size_t i = 0; i < dimensions; ++i) {
      const Set divided_by = fetch.projected ? coordinate[3].on : FlowSets::empty;
      fetch.coordinate.push_back(values_.sets.members(values_.sets.join(coordinate[i].on, divided_by)));
      fetch.exact.push_back(fetch.projected ? std::nullopt : exact(coordinate[i]));
    }
    Set modifiers = FlowSets::empty;
    if (fetch.type.shadow) modifiers = values_.sets.join(modifiers, coordinate[2].on);
    if (fetch.bias) modifiers = values_.sets.join(modifiers, coordinate[3].on);
    fetch.modifiers = values_.sets.members(modifiers);
    std::vector<ValueNumbers::Number> key{number_of(instruction.name), number_of(fetch.sampler),
                                          number_of(target)};
    const std::size_t used =
        fetch.projected || fetch.bias ? 4 : std::max(dimensions, std::size_t(fetch.type.shadow ? 3 : 1));
    for (std::size_t i = 0; i < used; ++i) key.push_back(coordinate[i].number);
    fetch.place = values_.numbers.of(ValueNumbers::place, key);
    write(instruction, texel(std::move(fetch)));
  }

  Value texel(Fetch fetch) {
    Value value;
    for (int i = 0; i < 4; ++i) {
      const Scalar component = source({.kind = SourceKind::texel,
                                       .name = fetch.sampler,
                                       .component = i,
                                       .components = 4,
                                       .rows = 4,
                                       .number = facts_.fetches.size()});
      value.push_back(
          {component.on, values_.numbers.of(ValueNumbers::component, {fetch.place, std::uint32_t(i)})});
    }
    facts_.fetches.push_back(std::move(fetch));
    return value;
  }

  std::optional<std::uint32_t> exact(const Scalar& scalar) const {
    const auto found = exact_.find(scalar.number);
    if (found == exact_.end()) return std::nullopt;
    return found->second;
  }

  /// OPTION ARB_fog_*: the fog coordinate fades colours, but not their opacity.
  void add_fog() {
    if (!fog_) return;
    const Value coordinate = read_register("fragment.fogcoord");
    const Value parameters = read_register("state.fog.params");
    const Value colour = read_register("state.fog.color");
    for (auto& [name, value] : registers_) {
      if (!name.starts_with("result.color")) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        const Set fog = values_.sets.join(values_.union_of(parameters), coordinate[0].on);
        value[i].on = values_.sets.join(values_.sets.join(value[i].on, fog), colour[i].on);
      }
    }
  }

  StageFacts exported() {
    for (const auto& [name, components] : written_) {
      for (std::size_t i = 0; i < 4; ++i) {
        Output output{.name = name, .component = int(i), .components = 4, .written = components[i]};
        const Scalar& value = registers_[name][i];
        if (output.written) output.on = values_.sets.members(value.on);
        if (output.written) output.exact = exact(value);
        facts_.outputs.push_back(std::move(output));
      }
    }
    return std::move(facts_);
  }

  Values values_{0};
  StageFacts facts_;
  std::map<std::string, std::string> bindings_;
  std::map<std::string, std::vector<std::string>> arrays_;
  std::map<std::string, Value> registers_;
  std::map<std::string, std::array<bool, 4>> written_;
  std::map<std::string, std::uint32_t> operators_;
  std::map<ValueNumbers::Number, std::uint32_t> exact_;
  bool fog_ = false;
};

}  // namespace

StageFinding analyse_assembly(const std::string& source) try {
  if (!source.starts_with("!!ARBfp1.0") && !source.starts_with("!!ARBvp1.0"))
    return Failure{Failure::Kind::unsupported, "an assembly program that is neither !!ARBfp1.0 nor !!ARBvp1.0"};
  return AssemblyWalk().facts(source);
} catch (const Unsupported& found) {
  return Failure{Failure::Kind::unsupported, found.what};
} catch (const TooLarge&) {
  return Failure{Failure::Kind::too_large, "the program is too large to follow"};
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception&) {
  return Failure{Failure::Kind::parse, "the assembly program cannot be read"};
}

}  // namespace understudy::spu::program
