// SPDX-License-Identifier: Apache-2.0
#include "spu/stream/plain_calls.h"

#include <cstring>

#include "dispatch/call_shape.h"

namespace understudy::spu {
namespace {

/// Whether every argument is a value, so that the record's words are the call's.
bool only_values(const CallShape& shape) {
  return shape.plain_words == shape.parameter_count + 1;
}

std::size_t array_bytes(const ParameterShape& parameter) {
  return value_size(parameter.type) * parameter.factor;
}

/// Copies a few values from an address and pads with zeros to a full word; writes only zeros for a null
/// address. In steps of four bytes: most arrays were just written in such pieces, and a wider load would wait
/// for these stores.
void copy_array(std::uint64_t address, std::size_t bytes, std::uint64_t* to) {
  const auto* from = reinterpret_cast<const std::byte*>(static_cast<std::uintptr_t>(address));
  auto* written = reinterpret_cast<std::byte*>(to);
  to[words_for(bytes) - 1] = 0;
  if (from == nullptr) {
    std::memset(to, 0, bytes);
    return;
  }
  std::size_t done = 0;
  for (; done + 4 <= bytes; done += 4) std::memcpy(written + done, from + done, 4);
  for (; done < bytes; ++done) written[done] = from[done];
}

/// Reads the arguments from a record with arrays; returns false if an array is missing.
bool read_arguments(const Record& record, const CallShape& shape, std::uint64_t* words) {
  std::size_t p = 0;
  for (const ParameterShape& parameter : shape.parameters()) {
    const std::uint64_t word = record.words[p + 1];
    if (parameter.pointer == 0) {
      words[p] = word;
    } else if (Reference::from(word).kind == ReferenceKind::null) {
      words[p] = 0;
    } else {
      const auto bytes = record.bytes(word);
      if (!bytes || bytes->size() < array_bytes(parameter)) return false;
      words[p] = reinterpret_cast<std::uintptr_t>(bytes->data());
    }
    ++p;
  }
  return true;
}

}  // namespace

void append_plain_call(Records& to, CallId call, const std::uint64_t* words) {
  const CallShape& shape = call_shape(call);
  if (only_values(shape)) return to.append_plain(stable_id(call), {words, shape.parameter_count});
  std::uint64_t* const record = to.append_record(stable_id(call), shape.plain_words);
  std::size_t p = 0;
  std::size_t end = shape.parameter_count + 1;
  for (const ParameterShape& parameter : shape.parameters()) {
    const std::uint64_t word = words[p++];
    if (parameter.pointer == 0) {
      record[p] = word;
    } else {
      const std::size_t bytes = array_bytes(parameter);
      record[p] = word == 0 ? Reference{}.word() : Reference{ReferenceKind::inside, end}.word();
      record[end] = bytes;
      copy_array(word, bytes, &record[end + 1]);
      end += 1 + words_for(bytes);
    }
  }
}

std::size_t make_plain_calls(std::span<const std::uint64_t> words, const DispatchTable& gl) {
  std::array<std::uint64_t, max_parameters> arguments;
  std::size_t at = 0;
  while (const auto record = record_at(words, at, {})) {
    const auto call = find_stable_id(record->id);
    if (!call || slot(gl, *call) == nullptr) break;
    const CallShape& shape = call_shape(*call);
    if (!shape.plain() || record->words.size() < shape.parameter_count + 1U) break;
    const std::uint64_t* made_with = record->words.data() + 1;
    if (!only_values(shape)) {
      if (!read_arguments(*record, shape, arguments.data())) break;
      made_with = arguments.data();
    }
    invoke(gl, *call, made_with);
    at += record->words.size();
  }
  return at;
}

}  // namespace understudy::spu
