// SPDX-License-Identifier: Apache-2.0
// Macros that a driver defines by what it supports. The front end supports other things: a source that tests
// such a macro gets the driver's value.
#pragma once

#include <span>
#include <string>
#include <variant>

#include "spu/volume/program/facts.h"

namespace understudy::spu::program {

/// Goes before the source.
inline constexpr const char* macro_preamble = "#define understudy_present 1\n";

/// Returns `source` with the names of extensions in directives replaced by understudy_present or, if they are
/// not among `extensions`, understudy_absent. Fails if it tests a macro that drivers define, and `extensions`
/// is null or the macro names no extension.
std::variant<std::string, Failure> with_driver_macros(const std::string& source,
                                                      const std::span<const std::string>* extensions);

}  // namespace understudy::spu::program
