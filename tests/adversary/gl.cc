// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/gl.h"

namespace adversary {

Gl load_gl() {
  Gl gl{};
#define ADVERSARY_GL_LOAD(name) gl.name = reinterpret_cast<decltype(gl.name)>(eglGetProcAddress("gl" #name));
  ADVERSARY_GL_FUNCTIONS(ADVERSARY_GL_LOAD)
#undef ADVERSARY_GL_LOAD
  return gl;
}

}  // namespace adversary
