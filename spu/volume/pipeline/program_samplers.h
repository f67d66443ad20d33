// SPDX-License-Identifier: Apache-2.0
// The samplers of the application's programs, queried from the driver once per link.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {

struct SamplerUniform {
  std::string name;
  GLenum type = 0;
  GLint location = -1;
};

class ProgramSamplers {
 public:
  /// Returns the samplers of 1-D, 2-D, 3-D and rectangle textures; none if the program's last link (number
  /// `link`) failed. The result stays valid until the next call for the same program.
  const std::vector<SamplerUniform>& of(const DispatchTable& gl, GLuint program, std::uint64_t link);

 private:
  std::map<GLuint, std::pair<std::uint64_t, std::vector<SamplerUniform>>> known_;
};

}  // namespace understudy::spu
