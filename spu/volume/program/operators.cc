// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program/operators.h"

#include <algorithm>
#include <array>

namespace understudy::spu::program {
namespace {

using namespace glslang;

constexpr std::array componentwise{EOpNegative,
                                   EOpLogicalNot,
                                   EOpVectorLogicalNot,
                                   EOpBitwiseNot,
                                   EOpAdd,
                                   EOpSub,
                                   EOpMul,
                                   EOpDiv,
                                   EOpMod,
                                   EOpRightShift,
                                   EOpLeftShift,
                                   EOpAnd,
                                   EOpInclusiveOr,
                                   EOpExclusiveOr,
                                   EOpVectorEqual,
                                   EOpVectorNotEqual,
                                   EOpLessThan,
                                   EOpGreaterThan,
                                   EOpLessThanEqual,
                                   EOpGreaterThanEqual,
                                   EOpVectorTimesScalar,
                                   EOpMatrixTimesScalar,
                                   EOpLogicalOr,
                                   EOpLogicalXor,
                                   EOpLogicalAnd,
                                   EOpMin,
                                   EOpMax,
                                   EOpClamp,
                                   EOpMix,
                                   EOpStep,
                                   EOpSmoothStep,
                                   EOpFma,
                                   EOpLdexp,
                                   EOpModf,
                                   EOpFrexp,
                                   EOpAddCarry,
                                   EOpSubBorrow,
                                   EOpUMulExtended,
                                   EOpIMulExtended,
                                   EOpBitfieldExtract,
                                   EOpBitfieldInsert,
                                   EOpBitFieldReverse,
                                   EOpBitCount,
                                   EOpFindLSB,
                                   EOpFindMSB,
                                   EOpMin3,
                                   EOpMax3,
                                   EOpMid3,
                                   EOpInterpolateAtCentroid};

constexpr bool between(TOperator op, TOperator first, TOperator last) {
  return op >= first && op <= last;
}

}  // namespace

Pattern pattern_of(TOperator op) {
  switch (op) {
    case EOpMatrixTimesVector:
      return Pattern::matrix_vector;
    case EOpVectorTimesMatrix:
      return Pattern::vector_matrix;
    case EOpMatrixTimesMatrix:
      return Pattern::matrix_matrix;
    case EOpTranspose:
      return Pattern::transposed;
    case EOpOuterProduct:
      return Pattern::outer_product;
    case EOpCross:
      return Pattern::cross_product;
    default:
      break;
  }
  const bool alike = std::ranges::find(componentwise, op) != componentwise.end() ||
                     between(op, EOpConvInt8ToBool, EOpConvDoubleToFloat) ||
                     between(op, EOpRadians, EOpFract) || between(op, EOpIsNan, EOpIsInf) ||
                     between(op, EOpFloatBitsToInt, EOpUintBitsToFloat) || is_derivative(op) ||
                     is_increment(op);
  return alike ? Pattern::componentwise : Pattern::mixed;
}

TOperator operator_of_assignment(TOperator op) {
  switch (op) {
    case EOpAddAssign:
      return EOpAdd;
    case EOpSubAssign:
      return EOpSub;
    case EOpMulAssign:
      return EOpMul;
    case EOpVectorTimesMatrixAssign:
      return EOpVectorTimesMatrix;
    case EOpVectorTimesScalarAssign:
      return EOpVectorTimesScalar;
    case EOpMatrixTimesScalarAssign:
      return EOpMatrixTimesScalar;
    case EOpMatrixTimesMatrixAssign:
      return EOpMatrixTimesMatrix;
    case EOpDivAssign:
      return EOpDiv;
    case EOpModAssign:
      return EOpMod;
    case EOpAndAssign:
      return EOpAnd;
    case EOpInclusiveOrAssign:
      return EOpInclusiveOr;
    case EOpExclusiveOrAssign:
      return EOpExclusiveOr;
    case EOpLeftShiftAssign:
      return EOpLeftShift;
    case EOpRightShiftAssign:
      return EOpRightShift;
    default:
      return EOpNull;
  }
}

bool is_derivative(TOperator op) {
  return between(op, EOpDPdx, EOpFwidthCoarse);
}

bool is_increment(TOperator op) {
  return between(op, EOpPostIncrement, EOpPreDecrement);
}

bool writes_parameter(TOperator op, std::size_t i) {
  switch (op) {
    case EOpModf:
    case EOpFrexp:
      return i == 1;
    case EOpAddCarry:
    case EOpSubBorrow:
      return i == 2;
    case EOpUMulExtended:
    case EOpIMulExtended:
      return i == 2 || i == 3;
    default:
      return false;
  }
}

}  // namespace understudy::spu::program
