// SPDX-License-Identifier: Apache-2.0
#include "spu/trace/call_recorder.h"

#include "spu/stream/answers.h"
#include "spu/stream/event.h"
#include "spu/stream/extent.h"

namespace understudy::spu {

bool CallRecorder::answers(CallId call) {
  return call_shape(call).result != ValueType::none || answers_names(call);
}

void CallRecorder::append_answers(CallId call, const std::uint64_t* words, std::uint64_t result, Records& to) {
  const auto parameters = call_shape(call).parameters();
  to.begin(event::answers);
  to.append(stable_id(call));
  to.append(result);
  std::size_t outputs = 0;
  for (const ParameterShape& parameter : parameters) outputs += answers_names(parameter) ? 1 : 0;
  to.reserve(outputs);
  std::size_t at = 3;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (!answers_names(parameters[p])) continue;
    const auto* names = reinterpret_cast<const std::byte*>(static_cast<std::uintptr_t>(words[p]));
    const std::size_t bytes = names == nullptr ? 0 : pointee_bytes(call, p, words).value_or(0);
    to.set(at++, to.attach({names, bytes}).word());
  }
}

}  // namespace understudy::spu
