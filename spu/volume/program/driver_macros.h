// SPDX-License-Identifier: Apache-2.0
// Macros that a driver defines by what it can do. The front end can other things: where the text asks for such
// a macro, it gets the driver's answer.
#pragma once

#include <span>
#include <string>
#include <variant>

#include "spu/volume/program/facts.h"

namespace understudy::spu::program {

/// Goes before the text.
inline constexpr const char* macro_preamble = "#define understudy_present 1\n";

/// `source` with the names of extensions in directives replaced by understudy_present or, of those that are not
/// among `extensions`, understudy_absent. Fails where a macro that drivers define is asked for and `extensions`
/// is null, or the macro names no extension.
std::variant<std::string, Failure> with_driver_macros(const std::string& source,
                                                      const std::span<const std::string>* extensions);

}  // namespace understudy::spu::program
