// SPDX-License-Identifier: Apache-2.0
#include "spu/stream/begin_and_end.h"

namespace understudy::spu {

bool BeginAndEnd::follow(CallId call, const std::uint64_t* words) {
  switch (call) {
    case CallId::Begin:
      inside_ = true;
      list_leaves_ = true;
      return false;
    case CallId::End:
      inside_ = false;
      list_leaves_ = false;
      return false;
    case CallId::NewList:
      list_ = GLuint(words[0]);
      list_only_compiles_ = GLenum(words[1]) == GL_COMPILE;
      inside_before_list_ = inside_;
      list_leaves_.reset();
      return false;
    case CallId::EndList:
      // The calls of a list that was only compiled have not been executed.
      if (list_only_compiles_) inside_ = inside_before_list_;
      list_effects_[list_] = list_leaves_;
      list_only_compiles_ = false;
      return false;
    case CallId::CallList: {
      const auto effect = list_effects_.find(GLuint(words[0]));
      if (effect == list_effects_.end() || !effect->second) return false;
      inside_ = *effect->second;
      list_leaves_ = effect->second;
      return true;
    }
    default:
      return false;
  }
}

}  // namespace understudy::spu
