// SPDX-License-Identifier: Apache-2.0
// The layout of a shader's variables: each scalar of a variable has a cell.
#pragma once

#include <glslang/Include/intermediate.h>

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "spu/volume/program/facts.h"

namespace understudy::spu::program {

using Cell = std::uint32_t;

/// Returns the number of scalars in a value of this type.
std::uint32_t cells_of(const glslang::TType& type);
/// The same for one element of an array.
std::uint32_t cells_of_element(const glslang::TType& array);
/// Returns the number of cells before a member.
std::uint32_t cells_before_member(const glslang::TType& structure, std::size_t member);

struct Variable {
  const glslang::TType* type = nullptr;
  std::string name;
  glslang::TStorageQualifier storage = glslang::EvqTemporary;
  Cell first = 0;
  std::uint32_t cells = 0;
  std::uint32_t elements = 1;  ///< of an array's outermost dimension; 1 if collapsed
  bool collapsed = false;      ///< all elements share the cells of one
};

struct Function {
  const glslang::TIntermAggregate* node = nullptr;
  std::vector<std::size_t> locals;  ///< variables, including parameters
  Cell returned = 0;                ///< first cell of the returned value
  std::uint32_t returned_cells = 0;
};

void for_each_child(const TIntermNode& node, const std::function<void(const TIntermNode*)>& visit);

class Variables {
 public:
  Variables(Stage stage, const TIntermNode& root);

  const Variable& of(const glslang::TIntermSymbol& symbol) const { return list_[by_id_.at(symbol.getId())]; }
  std::span<const Variable> list() const { return list_; }
  /// Returns whether the variable is new in every call of the function.
  bool is_local(const glslang::TIntermSymbol& symbol, const Function& function) const;
  /// Finds a function by the front end's name, which contains the parameter types; null for functions without a
  /// body.
  const Function* function(std::string_view name) const;
  std::uint32_t cells() const { return cells_; }
  /// Returns what a cell contains when the shader starts.
  Source source_of(Cell cell) const;

  /// Cells that ftransform reads.
  Cell fixed_vertex() const { return fixed_vertex_; }
  Cell fixed_matrix() const { return fixed_matrix_; }

 private:
  void visit(const TIntermNode* node, Function* function, int depth);
  void add(const glslang::TIntermSymbol& symbol, Function* function);
  void add_function(const glslang::TIntermAggregate& node, int depth);
  void lay_out();
  Cell take(std::uint64_t cells);

  Stage stage_;
  std::vector<Variable> list_;
  std::unordered_map<long long, std::size_t> by_id_;
  std::map<std::string, Function, std::less<>> functions_;
  Cell fixed_vertex_ = 0;
  Cell fixed_matrix_ = 0;
  std::uint32_t cells_ = 0;
};

/// Returns whether the variable is an output of the stage.
bool is_output(const Variable& variable);
/// Returns the name of the scalar, vector or matrix of `variable` that contains a cell, and the cell's
/// component.
Source named(const Variable& variable, Cell cell);

}  // namespace understudy::spu::program
