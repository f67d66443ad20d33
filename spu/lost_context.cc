// SPDX-License-Identifier: Apache-2.0
#include "spu/lost_context.h"

#include <utility>

#include "dispatch/call_words.h"

namespace understudy::spu {
namespace {

struct Lost {
  [[gnu::noinline]] static std::uint64_t call(CallId call, const std::uint64_t* words) {
    static constinit thread_local bool told = false;
    if (call == CallId::GetError) return std::exchange(told, true) ? GL_NO_ERROR : GL_OUT_OF_MEMORY;
    return answer_of_lost_context(call, words);
  }
};

/// No process has memory at smaller addresses: they are offsets into a query buffer.
constexpr std::uint64_t least_address = 65536;

template <class T>
void write_answer(std::uint64_t to, T value) {
  if (to >= least_address) *reinterpret_cast<T*>(static_cast<std::uintptr_t>(to)) = value;
}

/// `words`: of glGetQueryObject*, glGetShaderiv and glGetProgramiv. 0 names no object.
template <class T>
void write_if(const std::uint64_t* words, GLenum name) {
  if (words[0] != 0 && GLenum(words[1]) == name) write_answer<T>(words[2], GL_TRUE);
}

void write_sync_status(const std::uint64_t* words) {
  const auto room = GLsizei(words[2]);
  if (words[0] == 0 || GLenum(words[1]) != GL_SYNC_STATUS || room < 1) return;
  write_answer<GLsizei>(words[3], 1);
  write_answer<GLint>(words[4], GL_SIGNALED);
}

}  // namespace

std::uint64_t answer_of_lost_context(CallId call, const std::uint64_t* words) noexcept {
  switch (call) {
    case CallId::GetGraphicsResetStatus:
    case CallId::GetGraphicsResetStatusARB:
    case CallId::GetGraphicsResetStatusEXT:
    case CallId::GetGraphicsResetStatusKHR:
      return GL_UNKNOWN_CONTEXT_RESET;
    case CallId::ClientWaitSync:
      return GL_ALREADY_SIGNALED;
    case CallId::GetSynciv:
      write_sync_status(words);
      return 0;
    case CallId::GetQueryObjectiv:
    case CallId::GetQueryObjectivARB:
    case CallId::GetQueryObjectuiv:
    case CallId::GetQueryObjectuivARB:
      write_if<GLint>(words, GL_QUERY_RESULT_AVAILABLE);
      return 0;
    case CallId::GetQueryObjecti64v:
    case CallId::GetQueryObjecti64vEXT:
    case CallId::GetQueryObjectui64v:
    case CallId::GetQueryObjectui64vEXT:
      write_if<GLint64>(words, GL_QUERY_RESULT_AVAILABLE);
      return 0;
    case CallId::GetShaderiv:
    case CallId::GetProgramiv:
      write_if<GLint>(words, GL_COMPLETION_STATUS_KHR);
      return 0;
    default:
      return 0;
  }
}

const DispatchTable& lost_context() noexcept {
  static const DispatchTable table = [] {
    DispatchTable all{};
    AsWords<Lost>::fill(all);
    return all;
  }();
  return table;
}

}  // namespace understudy::spu
