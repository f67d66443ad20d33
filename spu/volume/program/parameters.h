// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "spu/volume/program/variables.h"

namespace understudy::spu::program {

inline const glslang::TIntermSequence& parameters_of(const Function& function) {
  return function.node->getSequence().at(0)->getAsAggregate()->getSequence();
}

/// Returns whether the caller receives what the function assigns to the parameter.
inline bool is_written(glslang::TStorageQualifier parameter) {
  return parameter == glslang::EvqOut || parameter == glslang::EvqInOut;
}

}  // namespace understudy::spu::program
