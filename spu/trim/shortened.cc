// SPDX-License-Identifier: Apache-2.0
#include "spu/trim/shortened.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <vector>

#include "dispatch/call_shape.h"
#include "spu/stream/event.h"
#include "spu/track/call_role.h"

namespace understudy::spu {
namespace {

constexpr std::size_t large_payload_words = std::size_t(1) << 20;
/// Limit for the nesting of lists in OpenGL.
constexpr int deepest_nesting = 64;

/// Words of the record that may refer to its block's payload.
std::vector<std::size_t> references_of(const Record& record) {
  std::vector<std::size_t> words;
  const auto add = [&](std::size_t word) {
    if (word < record.words.size()) words.push_back(word);
  };
  if (const auto call = find_stable_id(record.id)) {
    const auto parameters = call_shape(*call).parameters();
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      if (parameters[p].pointer != 0) add(p + 1);
    }
  } else if (record.id == event::arrays) {
    const std::uint64_t count = record.words.size() > 1 ? record.words[1] : 0;
    const std::size_t room =
        (record.words.size() - std::min<std::size_t>(2, record.words.size())) / event::words_per_array;
    for (std::size_t i = 0; i < std::min<std::uint64_t>(count, room); ++i)
      add(2 + i * event::words_per_array + 9);
  } else if (record.id == event::mapped_write) {
    add(3);
  } else if (record.id == event::answers) {
    const auto call = record.words.size() > 1 ? find_stable_id(std::uint32_t(record.words[1])) : std::nullopt;
    for (std::size_t i = 0; call && i < call_shape(*call).parameter_count; ++i) add(3 + i);
  }
  return words;
}

/// The names of lists in the arguments of glCallLists.
std::optional<std::vector<std::uint32_t>> list_names(const Record& record) {
  const auto data = record.words.size() > 3 ? record.bytes(record.words[3]) : std::nullopt;
  if (!data) return std::nullopt;
  const auto count = std::size_t(std::max(std::int32_t(record.words[1]), 0));
  std::size_t size = 0;
  switch (record.words[2]) {
    case GL_BYTE:
    case GL_UNSIGNED_BYTE:
      size = 1;
      break;
    case GL_SHORT:
    case GL_UNSIGNED_SHORT:
      size = 2;
      break;
    case GL_INT:
    case GL_UNSIGNED_INT:
      size = 4;
      break;
    default:
      return std::nullopt;
  }
  if (data->size() / size < count) return std::nullopt;
  std::vector<std::uint32_t> names(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t name = 0;
    std::memcpy(&name, data->data() + i * size, size);
    if (record.words[2] == GL_BYTE) name = std::uint32_t(std::int32_t(std::int8_t(name)));
    if (record.words[2] == GL_SHORT) name = std::uint32_t(std::int32_t(std::int16_t(name)));
    names[i] = name;
  }
  return names;
}

/// Whether the record is a call with all of its arguments.
bool is_whole(const Record& record) {
  const auto call = find_stable_id(record.id);
  return call && record.words.size() > call_shape(*call).parameter_count;
}

/// Copies an upload without its data, so that it only allocates the storage.
void copy_without_data(const Record& record, Records& to) {
  if (!is_whole(record)) return;
  const auto call = find_stable_id(record.id);
  const auto parameters = call_shape(*call).parameters();
  to.begin(record.id);
  for (std::size_t p = 0; p < parameters.size(); ++p)
    to.append(parameters[p].pointer != 0 ? Reference{}.word() : record.words[p + 1]);
}

/// Copies the record with its payload. Unknown calls lose their payload, whose references cannot be found.
void copy_record(const Record& record, Records& to) {
  to.begin(record.id);
  for (const std::uint64_t word : record.arguments()) to.append(word);
  for (const std::size_t word : references_of(record)) {
    if (Reference::from(record.words[word]).kind != ReferenceKind::payload) continue;
    if (const auto bytes = record.bytes(record.words[word])) to.set(word, to.attach(*bytes).word());
  }
}

}  // namespace

std::uint64_t Shortened::group_of(std::uint64_t context) const {
  for (std::size_t step = 0; step <= shares_with_.size(); ++step) {
    const auto found = shares_with_.find(context);
    if (found == shares_with_.end() || found->second == 0) return context;
    context = found->second;
  }
  return context;
}

/// Tracks the state of the stream that is needed to find display lists.
void Shortened::follow(const Record& record) {
  const auto words = record.arguments();
  if (words.empty()) return;
  if (record.id == event::thread) thread_ = words[0];
  if (record.id == event::context && words.size() > 1) shares_with_[words[0]] = words[1];
  ThreadState& thread = threads_[thread_];
  if (record.id == event::current) thread.context = words[0];
  const auto call = find_stable_id(record.id);
  if (call == CallId::ListBase && !thread.compiling) list_base_[thread.context] = std::uint32_t(words[0]);
  if (call == CallId::NewList) {
    thread.compiling = true;
    thread.list = {group_of(thread.context), std::uint32_t(words[0])};
    lists_[thread.list].clear();
  }
}

void Shortened::take(const Record& record, RecordAction action) {
  follow(record);
  ThreadState& thread = threads_[thread_];
  const auto call = find_stable_id(record.id);
  if (call == CallId::EndList) thread.compiling = false;
  if (thread.compiling && call != CallId::NewList && (call || record.id == event::arrays))
    copy_record(record, lists_[thread.list]);
  switch (action) {
    case RecordAction::keep:
      copy_record(record, records_);
      break;
    case RecordAction::keep_without_data:
      copy_without_data(record, records_);
      break;
    case RecordAction::expand:
      expand(record, 0);
      break;
    case RecordAction::drop:
      break;
  }
  write_when_large();
}

void Shortened::expand_list(std::uint32_t name, int depth) {
  const auto found = lists_.find({group_of(threads_[thread_].context), name});
  if (found == lists_.end() || depth > deepest_nesting) return;
  const Records& list = found->second;
  std::size_t position = 0;
  while (const auto record = record_at(list.words(), position, list.payload())) {
    position += record->words.size();
    const auto call = find_stable_id(record->id);
    if (!is_whole(*record)) continue;
    switch (role_of(*call)) {
      case CallRole::call_list:
        expand(*record, depth + 1);
        break;
      case CallRole::state:
      case CallRole::attribute:
        if (call == CallId::ListBase) list_base_[threads_[thread_].context] = std::uint32_t(record->words[1]);
        copy_record(*record, records_);
        break;
      default:
        break;
    }
  }
}

void Shortened::expand(const Record& record, int depth) {
  if (!is_whole(record)) return;
  if (find_stable_id(record.id) == CallId::CallList) {
    expand_list(std::uint32_t(record.words[1]), depth);
    return;
  }
  const auto names = list_names(record);
  if (!names) {
    copy_record(record, records_);
    return;
  }
  for (const std::uint32_t name : *names) expand_list(list_base_[threads_[thread_].context] + name, depth);
}

void Shortened::take(const Record& record) {
  if (record.id != event::frame) {
    copy_record(record, records_);
    write_when_large();
    return;
  }
  copy_record(record, records_);
  records_.set(1, ++frames_);
  ++frames_in_block_;
  finish();
}

void Shortened::take_all(const Records& records) {
  std::size_t position = 0;
  while (const auto record = record_at(records.words(), position, records.payload())) {
    position += record->words.size();
    copy_record(*record, records_);
    write_when_large();
  }
}

void Shortened::write_when_large() {
  if (records_.words().size() + records_.payload().size() >= large_payload_words) finish();
}

void Shortened::finish() {
  if (records_.empty()) return;
  writer_.write(records_, frames_in_block_);
  records_.clear();
  frames_in_block_ = 0;
}

}  // namespace understudy::spu
