// SPDX-License-Identifier: Apache-2.0
#include "spu/print/record_text.h"

#include <fmt/format.h>

#include <array>

#include "dispatch/call_shape.h"
#include "spu/print/call_text.h"
#include "spu/stream/answers.h"
#include "spu/stream/client_arrays.h"
#include "spu/stream/event.h"
#include "spu/stream/extent.h"

namespace understudy::spu {
namespace {

constexpr std::array<const char*, array_role_count> role_names = {"vertex",          "normal",
                                                                  "color",           "secondary color",
                                                                  "fog coordinate",  "index",
                                                                  "edge flag",       "texture coordinate",
                                                                  "attribute",       "integer attribute",
                                                                  "double attribute"};

bool has_answer(CallId call) {
  return call_shape(call).result != ValueType::none || answers_names(call);
}

/// Such a call cannot wait for its answer, because the payload is gone by then.
bool refers_to_payload(const Record& record, const CallShape& shape) {
  for (std::size_t p = 0; p < shape.parameter_count && p + 1 < record.words.size(); ++p) {
    const bool pointer = shape.parameters()[p].pointer != 0;
    if (pointer && Reference::from(record.words[p + 1]).kind == ReferenceKind::payload) return true;
  }
  return false;
}

std::string or_number(const char* name, std::uint64_t value) {
  return name != nullptr ? name : fmt::format("{:#x}", value);
}

/// Arguments that the call writes to are not in the record: prints "..." instead of NULL.
std::string with_outputs(std::string text, const CallShape& shape, std::uint32_t outputs) {
  for (std::size_t p = 0; p < shape.parameter_count; ++p) {
    if ((outputs >> p & 1U) == 0) continue;
    const std::string empty = fmt::format("{} = NULL", shape.parameters()[p].name());
    const std::size_t at = text.find(empty);
    if (at != std::string::npos) text.replace(at + empty.size() - 4, 4, "...");
  }
  return text;
}

}  // namespace

RecordText::RecordText(std::function<void(std::string_view)> line,
                       std::function<bool(std::string_view)> wants_call)
    : line_(std::move(line)), wants_call_(std::move(wants_call)) {}

std::string RecordText::call_line(const Record& record, const Record* answers) {
  Decoder::ReadCall read;
  if (std::string error = decoder_.read(record, read); !error.empty()) return error;
  const CallId call = read.id;
  auto& words = read.words;
  const CallShape& shape = call_shape(call);
  UnreadArguments outputs = 0;
  UnreadArguments unread = 0;
  std::size_t at = 2;
  for (std::size_t p = 0; p < shape.parameter_count; ++p) {
    const ParameterShape& parameter = shape.parameters()[p];
    if (parameter.pointer != 0 && read.kinds[p] == ReferenceKind::address) unread |= 1U << p;
    if (parameter.pointer == 0 || read.kinds[p] != ReferenceKind::output) continue;
    words[p] = 0;
    outputs |= 1U << p;
    if (!answers_names(parameter) || answers == nullptr || at >= answers->arguments().size()) continue;
    const auto names = answers->bytes(answers->arguments()[at++]);
    if (!names || names->size() < pointee_bytes(call, p, words.data()).value_or(~std::size_t(0))) continue;
    words[p] = reinterpret_cast<std::uintptr_t>(names->data());
    outputs &= ~(1U << p);
  }
  // Strings and mappings that OpenGL returned are not in the stream.
  const bool number = shape.result_pointer == 0;
  const std::uint64_t result =
      number && answers != nullptr && answers->arguments().size() > 1 ? answers->arguments()[1] : 0;
  fmt::memory_buffer text;
  append_call(text, call, words.data(), result, unread);
  std::string line = with_outputs(fmt::to_string(text), shape, outputs);
  if (!number) line.resize(line.rfind(" = "));
  return line;
}

void RecordText::tell_waiting(std::uint64_t thread, const Record* answers) {
  const auto found = waiting_.find(thread);
  if (found == waiting_.end()) return;
  const std::vector<std::uint64_t> words = std::move(found->second);
  waiting_.erase(found);
  line_(call_line({std::uint32_t(words[0]), words, {}}, answers));
}

void RecordText::tell_call(const Record& record) {
  tell_waiting(thread_, nullptr);
  const auto call = find_stable_id(record.id);
  if (!call) {
    if (!wants_call_) line_(fmt::format("unknown record {:#010x}, {} words", record.id, record.words.size()));
    return;
  }
  if (wants_call_ && !wants_call_(call_name(*call))) return;
  if (has_answer(*call) && !refers_to_payload(record, call_shape(*call))) {
    waiting_[thread_] = {record.words.begin(), record.words.end()};
  } else {
    line_(call_line(record, nullptr));
  }
}

void RecordText::tell_arrays(const Record& record) {
  const auto words = record.arguments();
  const std::uint64_t count = words.empty() ? 0 : words[0];
  if (words.empty() || count > (words.size() - 1) / event::words_per_array)
    return line_("vertex arrays: fewer than announced");
  std::string text = "vertex arrays:";
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto field = words.subspan(1 + i * event::words_per_array, event::words_per_array);
    const auto data = record.bytes(field[9]);
    text += fmt::format("{} {} {} of {} {} from element {}, {} bytes", i == 0 ? "" : ",",
                        field[0] < array_role_count ? role_names[field[0]] : "unknown role", field[1], field[2],
                        or_number(enum_name(std::uint32_t(field[3]), 0), field[3]), field[8],
                        data ? data->size() : 0);
  }
  line_(text);
}

void RecordText::tell(const Record& record) {
  const auto words = record.arguments();
  const auto word = [&](std::size_t at) { return at < words.size() ? words[at] : 0; };
  if (record.id == event::thread) {
    thread_ = word(0);
    if (!wants_call_) line_(fmt::format("thread {}", thread_));
    return;
  }
  if (record.id == event::answers) return tell_waiting(thread_, &record);
  if (event::name_of(record.id) == nullptr) return tell_call(record);
  tell_waiting(thread_, nullptr);
  if (wants_call_) return;
  switch (record.id) {
    case event::arrays:
      return tell_arrays(record);
    case event::arrays_end:
      return line_("vertex arrays end");
    case event::context:
      return line_(
          fmt::format("context {} appears: shares with {}, OpenGL {}.{}, profile {:#x}, bits {} {} {} {}, "
                      "depth {}, stencil "
                      "{}, samples {}, {} buffered",
                      word(0), word(1), word(3) / 100, word(3) / 10 % 10, word(4), word(5), word(6), word(7),
                      word(8), word(9), word(10), word(11), word(12) != 0 ? "doubly" : "singly"));
    case event::current:
      return line_(word(0) == 0 ? std::string("no context is current")
                                : fmt::format("context {} is current, {} x {}", word(0), word(1), word(2)));
    case event::context_gone:
      return line_(fmt::format("context {} is gone", word(0)));
    case event::frame:
      return line_(fmt::format("frame {}, {} x {}", word(0), word(1), word(2)));
    case event::mapped_write: {
      const auto data = record.bytes(word(2));
      return line_(fmt::format("mapped buffer at {:#x}: {} bytes written at {}", word(0),
                               data ? data->size() : 0, word(1)));
    }
    default:
      return line_(event::name_of(record.id));
  }
}

void RecordText::finish() {
  while (!waiting_.empty()) tell_waiting(waiting_.begin()->first, nullptr);
}

}  // namespace understudy::spu
