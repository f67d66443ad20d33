// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program/variables.h"

#include <algorithm>

#include "spu/volume/program/flow_sets.h"

namespace understudy::spu::program {
namespace {

using glslang::TType;

constexpr std::uint32_t max_cells_of_variable = 2048;
constexpr std::uint64_t max_cells = 100'000;
/// Limit of nested nodes: the walk recurses for every level.
constexpr int max_depth = 1000;

/// Unsized arrays have as many elements as the source uses.
std::uint32_t elements_of(const TType& array, int dimension) {
  const glslang::TArraySizes& sizes = *array.getArraySizes();
  const unsigned size = unsigned(sizes.getDimSize(dimension));
  if (size != glslang::UnsizedArraySize) return std::max(size, 1U);
  return dimension == 0 ? std::uint32_t(std::max(array.getImplicitArraySize(), 1)) : 1U;
}

std::uint32_t cells_without_array(const TType& type) {
  if (type.getBasicType() == glslang::EbtVoid) return 0;
  if (type.isStruct()) return cells_before_member(type, type.getStruct()->size());
  if (type.isMatrix()) return std::uint32_t(type.getMatrixCols() * type.getMatrixRows());
  return std::uint32_t(std::max(type.getVectorSize(), 1));
}

std::uint32_t within_limit(std::uint64_t cells) {
  if (cells > max_cells) throw TooLarge();
  return std::uint32_t(cells);
}

std::uint32_t cells_from_dimension(const TType& type, int first) {
  std::uint64_t cells = cells_without_array(type);
  const int dimensions = type.isArray() ? type.getArraySizes()->getNumDims() : 0;
  for (int dimension = first; dimension < dimensions; ++dimension)
    cells = within_limit(cells * elements_of(type, dimension));
  return within_limit(cells);
}

bool is_anonymous(std::string_view name) {
  return name.starts_with("anon@");
}

bool is_block(const TType& type) {
  return type.getBasicType() == glslang::EbtBlock;
}

SourceKind kind_of_input(glslang::TBuiltInVariable builtin, Stage stage) {
  switch (builtin) {
    case glslang::EbvFragCoord:
      return SourceKind::fragment_coordinate;
    case glslang::EbvFace:
      return SourceKind::front_facing;
    case glslang::EbvPointCoord:
      return SourceKind::point_coordinate;
    case glslang::EbvSampleId:
    case glslang::EbvSamplePosition:
    case glslang::EbvSampleMask:
      return SourceKind::sample;
    case glslang::EbvPrimitiveId:
      return SourceKind::primitive;
    case glslang::EbvLayer:
    case glslang::EbvViewportIndex:
      return SourceKind::layer;
    case glslang::EbvVertexId:
    case glslang::EbvInstanceId:
    case glslang::EbvBaseVertex:
    case glslang::EbvBaseInstance:
    case glslang::EbvDrawId:
    case glslang::EbvInvocationId:
      return SourceKind::vertex_index;
    case glslang::EbvHelperInvocation:
      return SourceKind::derivative;
    default:
      return stage == Stage::vertex ? SourceKind::attribute : SourceKind::varying;
  }
}

SourceKind kind_of(const Variable& variable, Stage stage) {
  switch (variable.storage) {
    case glslang::EvqUniform:
      return is_block(*variable.type) ? SourceKind::uniform_block : SourceKind::uniform;
    case glslang::EvqBuffer:
      return SourceKind::storage_buffer;
    case glslang::EvqVaryingIn:
    case glslang::EvqFace:
    case glslang::EvqFragCoord:
    case glslang::EvqPointCoord:
    case glslang::EvqVertexId:
    case glslang::EvqInstanceId:
      return kind_of_input(variable.type->getQualifier().builtIn, stage);
    default:
      return SourceKind::undefined;
  }
}

bool begins_anew(const Variable& variable) {
  switch (variable.storage) {
    case glslang::EvqTemporary:
    case glslang::EvqIn:
    case glslang::EvqOut:
    case glslang::EvqInOut:
    case glslang::EvqConstReadOnly:
      return true;
    default:
      return false;
  }
}

/// Descends a type to the scalar, vector or matrix that contains a cell.
class LeafName {
 public:
  LeafName(const Variable& variable, std::uint32_t offset) : collapsed_(variable.collapsed), offset_(offset) {
    source_.name = variable.name;
    if (is_block(*variable.type) && !is_anonymous(variable.name))
      source_.name = variable.type->getTypeName().c_str();
    descend(*variable.type, is_anonymous(variable.name));
  }

  const Source& source() const { return source_; }

 private:
  void descend(const TType& type, bool anonymous) {
    descend_array(type);
    if (type.isStruct()) {
      descend_member(type, anonymous);
    } else {
      source_.component = int(offset_);
      source_.components = int(cells_without_array(type));
      source_.rows = type.isMatrix() ? type.getMatrixRows() : source_.components;
    }
  }

  void descend_array(const TType& type) {
    const int dimensions = type.isArray() ? type.getArraySizes()->getNumDims() : 0;
    for (int dimension = 0; dimension < dimensions; ++dimension) {
      const std::uint32_t cells = std::max(cells_from_dimension(type, dimension + 1), 1U);
      source_.name += collapsed_ ? "[*]" : "[" + std::to_string(offset_ / cells) + "]";
      offset_ %= cells;
      collapsed_ = false;
    }
  }

  void descend_member(const TType& type, bool anonymous) {
    for (const glslang::TTypeLoc& member : *type.getStruct()) {
      const std::uint32_t cells = cells_of(*member.type);
      if (offset_ < cells) {
        const std::string name = member.type->getFieldName().c_str();
        source_.name = anonymous ? name : source_.name + "." + name;
        return descend(*member.type, false);
      }
      offset_ -= cells;
    }
  }

  bool collapsed_;
  std::uint32_t offset_;
  Source source_;
};

}  // namespace

std::uint32_t cells_of(const TType& type) {
  return cells_from_dimension(type, 0);
}

std::uint32_t cells_of_element(const TType& array) {
  return cells_from_dimension(array, 1);
}

std::uint32_t cells_before_member(const TType& structure, std::size_t member) {
  std::uint64_t cells = 0;
  for (std::size_t i = 0; i < member; ++i) cells += cells_of(*(*structure.getStruct())[i].type);
  return within_limit(cells);
}

void for_each_child(const TIntermNode& node, const std::function<void(const TIntermNode*)>& visit) {
  if (const auto* aggregate = node.getAsAggregate()) {
    for (const TIntermNode* child : aggregate->getSequence()) visit(child);
  } else if (const auto* binary = node.getAsBinaryNode()) {
    visit(binary->getLeft());
    visit(binary->getRight());
  } else if (const auto* unary = node.getAsUnaryNode()) {
    visit(unary->getOperand());
  } else if (const auto* selection = node.getAsSelectionNode()) {
    visit(selection->getCondition());
    visit(selection->getTrueBlock());
    visit(selection->getFalseBlock());
  } else if (const auto* loop = node.getAsLoopNode()) {
    visit(loop->getTest());
    visit(loop->getBody());
    visit(loop->getTerminal());
  } else if (const auto* branch = node.getAsBranchNode()) {
    visit(branch->getExpression());
  } else if (const auto* choice = node.getAsSwitchNode()) {
    visit(choice->getCondition());
    visit(choice->getBody());
  }
}

Variables::Variables(Stage stage, const TIntermNode& root) : stage_(stage) {
  visit(&root, nullptr, 0);
  lay_out();
}

const Function* Variables::function(std::string_view name) const {
  const auto found = functions_.find(name);
  return found == functions_.end() ? nullptr : &found->second;
}

bool Variables::is_local(const glslang::TIntermSymbol& symbol, const Function& function) const {
  const auto variable = by_id_.find(symbol.getId());
  return variable != by_id_.end() &&
         std::ranges::find(function.locals, variable->second) != function.locals.end();
}

void Variables::visit(const TIntermNode* node, Function* function, int depth) {
  if (node == nullptr) return;
  if (depth > max_depth) throw TooLarge();
  if (const auto* symbol = node->getAsSymbolNode()) return add(*symbol, function);
  const auto* aggregate = node->getAsAggregate();
  if (aggregate != nullptr && aggregate->getOp() == glslang::EOpFunction)
    return add_function(*aggregate, depth);
  for_each_child(*node, [&](const TIntermNode* child) { visit(child, function, depth + 1); });
}

void Variables::add_function(const glslang::TIntermAggregate& node, int depth) {
  Function& function = functions_[node.getName().c_str()];
  function.node = &node;
  for_each_child(node, [&](const TIntermNode* child) { visit(child, &function, depth + 1); });
}

void Variables::add(const glslang::TIntermSymbol& symbol, Function* function) {
  const TType& type = symbol.getType();
  const auto [known, is_new] = by_id_.emplace(symbol.getId(), list_.size());
  if (is_new) {
    list_.push_back({.type = &type, .name = symbol.getName().c_str(), .storage = type.getQualifier().storage});
    if (function != nullptr && begins_anew(list_.back())) function->locals.push_back(known->second);
  }
  Variable& variable = list_[known->second];
  if (type.isArray()) variable.elements = std::max(variable.elements, elements_of(type, 0));
}

void Variables::lay_out() {
  for (Variable& variable : list_) {
    const TType& type = *variable.type;
    std::uint64_t cells = cells_without_array(type);
    if (type.isArray()) {
      cells = cells_of_element(type);
      variable.collapsed = cells * variable.elements > max_cells_of_variable;
      if (variable.collapsed) variable.elements = 1;
      cells *= variable.elements;
    }
    variable.cells = within_limit(cells);
    variable.first = take(cells);
  }
  for (auto& [name, function] : functions_) {
    function.returned_cells = cells_of(function.node->getType());
    function.returned = take(function.returned_cells);
  }
  fixed_vertex_ = take(4);
  fixed_matrix_ = take(16);
}

Cell Variables::take(std::uint64_t cells) {
  const Cell first = cells_;
  cells_ = within_limit(cells_ + cells);
  return first;
}

Source Variables::source_of(Cell cell) const {
  if (cell >= fixed_matrix_)
    return {.kind = SourceKind::uniform,
            .name = "gl_ModelViewProjectionMatrix",
            .component = int(cell - fixed_matrix_),
            .components = 16,
            .rows = 4};
  if (cell >= fixed_vertex_)
    return {.kind = SourceKind::attribute,
            .name = "gl_Vertex",
            .component = int(cell - fixed_vertex_),
            .components = 4,
            .rows = 4};
  // Variables are in the order of the list, followed by the returned values.
  const auto after = std::ranges::upper_bound(list_, cell, {}, &Variable::first);
  if (after == list_.begin()) return {.kind = SourceKind::undefined, .name = "a returned value"};
  auto variable = std::prev(after);
  while (variable->cells == 0 && variable != list_.begin()) --variable;
  if (cell >= variable->first + variable->cells)
    return {.kind = SourceKind::undefined, .name = "a returned value"};
  Source source = named(*variable, cell);
  source.kind = kind_of(*variable, stage_);
  return source;
}

bool is_output(const Variable& variable) {
  switch (variable.storage) {
    case glslang::EvqVaryingOut:
    case glslang::EvqPosition:
    case glslang::EvqPointSize:
    case glslang::EvqClipVertex:
    case glslang::EvqFragColor:
    case glslang::EvqFragDepth:
    case glslang::EvqFragStencil:
      return true;
    default:
      return false;
  }
}

Source named(const Variable& variable, Cell cell) {
  return LeafName(variable, cell - variable.first).source();
}

}  // namespace understudy::spu::program
