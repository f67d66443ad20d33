// SPDX-License-Identifier: Apache-2.0
// Uses features that run --remote does not support, and continues to draw: copies a context's state, and
// requests messages by debug callbacks. Prints the messages. Exits with status 0 if it survives.
#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>

#include <array>
#include <cstdio>
#include <string_view>

#include "tests/clients/x_window.h"

namespace {

int told = 0;

void APIENTRY tell(GLenum, GLenum, GLuint, GLenum, GLsizei, const GLchar*, const void*) {
  ++told;
}

template <class Function>
Function function(const char* name) {
  return reinterpret_cast<Function>(glXGetProcAddressARB(reinterpret_cast<const GLubyte*>(name)));
}

}  // namespace

int main() {
  const client::XWindow window(client::Buffers::two);
  GLXContext const current = glXGetCurrentContext();
  glXCopyContext(window.display(), current, current, GL_ALL_ATTRIB_BITS);
  glXCopyContext(window.display(), current, current, GL_LIGHTING_BIT);
  for (const char* name : {"glXUseXFont", "glXCopyContext", "glDebugMessageCallback"})
    if (function<void (*)()>(name) == nullptr) return 4;

  glEnable(GL_DEBUG_OUTPUT);
  glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  function<PFNGLDEBUGMESSAGECALLBACKPROC>("glDebugMessageCallback")(&tell, &told);
  function<PFNGLDEBUGMESSAGECALLBACKARBPROC>("glDebugMessageCallbackARB")(&tell, nullptr);
  const std::string_view message = "said by the application";
  function<PFNGLDEBUGMESSAGEINSERTPROC>("glDebugMessageInsert")(GL_DEBUG_SOURCE_APPLICATION,
                                                                GL_DEBUG_TYPE_MARKER, 1, GL_DEBUG_SEVERITY_HIGH,
                                                                GLsizei(message.size()), message.data());
  glEnable(GL_TEXTURE_MIN_FILTER);
  if (glGetError() != GL_INVALID_ENUM) return 5;
  function<PFNGLDEBUGMESSAGECALLBACKPROC>("glDebugMessageCallback")(nullptr, nullptr);
  std::array<GLchar, 256> log{};
  GLsizei length = 0;
  const GLuint count = function<PFNGLGETDEBUGMESSAGELOGPROC>("glGetDebugMessageLog")(
      1, GLsizei(log.size()), nullptr, nullptr, nullptr, nullptr, &length, log.data());
  std::printf("told %d times, %u in the log, %d characters, error %x\n", told, count, length, glGetError());
  glClear(GL_COLOR_BUFFER_BIT);
  window.swap();
  glFinish();
  return glGetError() == GL_NO_ERROR ? 0 : 6;
}
