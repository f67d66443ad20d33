// SPDX-License-Identifier: Apache-2.0
// Evaluates operators and constructors.
#include <algorithm>
#include <array>

#include "spu/volume/program/walk.h"

namespace understudy::spu::program {

using namespace glslang;

namespace {

bool is_exact(const TType& type) {
  return type.isIntegerDomain() || type.getBasicType() == EbtBool;
}

}  // namespace

Value Walk::apply(TOperator op, const TType& type, std::span<const Value> operands,
                  std::span<const TType* const> types) {
  const std::size_t cells = cells_of(type);
  const bool compares_scalars = (op == EOpEqual || op == EOpNotEqual) && operands[0].size() == 1;
  switch (compares_scalars ? Pattern::componentwise : pattern_of(op)) {
    case Pattern::componentwise: {
      const Value value = values_.componentwise(op, cells, operands, is_exact(type));
      return is_derivative(op) || op == EOpInterpolateAtCentroid
                 ? values_.with(value, own_source(SourceKind::derivative, "derivative"))
                 : value;
    }
    case Pattern::matrix_vector:
      return values_.product(op, operands[0], operands[1], cells, operands[1].size());
    case Pattern::vector_matrix:
      return values_.product(op, operands[0], operands[1], 1, operands[0].size());
    case Pattern::matrix_matrix:
      return values_.product(op, operands[0], operands[1], std::size_t(types[0]->getMatrixRows()),
                             std::size_t(types[0]->getMatrixCols()));
    case Pattern::transposed:
      return values_.transposed(operands[0], std::size_t(type.getMatrixCols()));
    case Pattern::outer_product:
      return values_.outer_product(op, operands[0], operands[1]);
    case Pattern::cross_product:
      return values_.cross_product(op, operands[0], operands[1]);
    case Pattern::mixed:
      break;
  }
  return values_.mixed(op, cells, operands);
}

Value Walk::construct(const TType& type, const TIntermSequence& arguments) {
  const std::vector<Value> values = evaluate_all(arguments);
  Value all;
  for (const Value& value : values) all.insert(all.end(), value.begin(), value.end());
  const std::size_t cells = cells_of(type);
  if (!type.isArray() && !type.isStruct() && values.size() == 1) {
    const TType& only = arguments[0]->getAsTyped()->getType();
    if (type.isMatrix() && (only.isMatrix() || all.size() == 1)) return construct_matrix(type, all, only);
    if (all.size() == 1) all.resize(cells, all[0]);
  }
  // Longer vectors are truncated.
  all.resize(cells, values_.constant(0));
  return all;
}

/// From a scalar the diagonal, from another matrix the common part; the rest as in the identity.
Value Walk::construct_matrix(const TType& type, const Value& from, const TType& from_type) {
  Value value;
  const int from_rows = from_type.isMatrix() ? from_type.getMatrixRows() : 0;
  const int from_columns = from_type.isMatrix() ? from_type.getMatrixCols() : 0;
  for (int column = 0; column < type.getMatrixCols(); ++column) {
    for (int row = 0; row < type.getMatrixRows(); ++row) {
      if (row < from_rows && column < from_columns)
        value.push_back(from[std::size_t(column) * std::size_t(from_rows) + std::size_t(row)]);
      else if (row == column)
        value.push_back(from_rows == 0 ? from[0] : values_.constant(1));
      else
        value.push_back(values_.constant(0));
    }
  }
  return value;
}

}  // namespace understudy::spu::program
