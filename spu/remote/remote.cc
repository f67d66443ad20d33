// SPDX-License-Identifier: Apache-2.0
#include "spu/remote/remote.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>
#include <utility>

#include "spu/chain_text.h"
#include "spu/lost_context.h"
#include "spu/pack/pack.h"
#include "spu/stream/answers.h"
#include "spu/stream/event.h"
#include "spu/stream/extent.h"
#include "spu/stream/mapping_calls.h"

namespace understudy::spu {
namespace {

/// Limit for an answer whose extent is unknown.
constexpr std::size_t most_unknown_bytes = std::size_t(64) * 1024;
/// Limit for the extensions queried at once; contexts have some hundreds.
constexpr GLint most_extensions = 4096;
/// Limit for one query of a mapped buffer's contents.
constexpr std::uint64_t most_refreshed_bytes = std::uint64_t(16) << 20;

std::byte* memory_at(std::uint64_t word) {
  return reinterpret_cast<std::byte*>(static_cast<std::uintptr_t>(word));
}

/// Whether the call's result or output must be available before the application continues.
bool answers(CallId call) {
  static const std::vector<bool> all = [] {
    std::vector<bool> table(call_count);
    for (std::size_t i = 0; i < call_count; ++i) {
      const CallShape& shape = call_shape(CallId(i));
      const auto parameters = shape.parameters();
      table[i] = shape.result != ValueType::none ||
                 std::any_of(parameters.begin(), parameters.end(), [](const ParameterShape& parameter) {
                   return parameter.pointer != 0 && !parameter.input;
                 });
    }
    return table;
  }();
  return all[std::size_t(call)];
}

/// Whether the query always returns the same value in a context.
bool is_constant(CallId call, const std::uint64_t* words) {
  switch (call) {
    case CallId::GetIntegerv:
    case CallId::GetInteger64v:
    case CallId::GetFloatv:
    case CallId::GetDoublev:
    case CallId::GetBooleanv:
      break;
    default:
      return false;
  }
  const auto name = GLenum(words[0]);
  constexpr std::array<GLenum, 5> others = {GL_MAJOR_VERSION, GL_MINOR_VERSION, GL_NUM_EXTENSIONS,
                                            GL_CONTEXT_FLAGS, GL_CONTEXT_PROFILE_MASK};
  if (std::find(others.begin(), others.end(), name) != others.end()) return true;
  const char* text = enum_name(name, 0);
  return text != nullptr && std::string_view(text).starts_with("GL_MAX_");
}

bool is_integer_query(CallId call) {
  return call == CallId::GetIntegerv || call == CallId::GetBooleanv;
}

bool is_text(CallId call) {
  return call == CallId::GetString || call == CallId::GetStringi;
}

std::uint64_t words_of_text(CallId call, const std::uint64_t* words) {
  return words[0] << 32 | (call == CallId::GetStringi ? std::uint32_t(words[1]) + 1 : 0);
}

/// Whether the answered call shows that OpenGL has executed the calls before it, or before a fence, so that the
/// application may read what they have written into persistent mappings.
bool has_waited(const PackedCall& call, std::uint64_t result) {
  switch (call.call) {
    case CallId::Finish:
      return true;
    case CallId::ClientWaitSync:
      return result == GL_ALREADY_SIGNALED || result == GL_CONDITION_SATISFIED;
    case CallId::GetSynciv: {
      const bool asks = GLenum(call.words[1]) == GL_SYNC_STATUS && GLsizei(call.words[2]) > 0;
      return asks && call.words[4] != 0 &&
             *reinterpret_cast<const GLint*>(memory_at(call.words[4])) == GL_SIGNALED;
    }
    default:
      return false;
  }
}

}  // namespace

Remote::Remote(Chain& chain, ServerConnection& server)
    : chain_(chain),
      server_(server),
      pack_(*chain.find<Pack>()),
      question_encoder_(remote_driver(), [] {}),
      front_(true, chain.group()) {
  pack_.hand_to(*this);
  question_encoder_.hide_addresses();
}

void Remote::introduce() {
  introduced_ = true;
  context_ = server_.front().context();
  front_ = FrontBuffer(context_.double_buffered, chain_.group());
  const std::array<std::uint64_t, event::context_words> words = {chain_.surroundings().context,
                                                                 chain_.surroundings().shares_with,
                                                                 0,
                                                                 std::uint64_t(context_.version),
                                                                 context_.profile,
                                                                 std::uint64_t(context_.red),
                                                                 std::uint64_t(context_.green),
                                                                 std::uint64_t(context_.blue),
                                                                 std::uint64_t(context_.alpha),
                                                                 std::uint64_t(context_.depth),
                                                                 std::uint64_t(context_.stencil),
                                                                 std::uint64_t(context_.samples),
                                                                 context_.double_buffered};
  Records records;
  records.append_plain(event::context, words);
  server_.send(records);
}

void Remote::tell_current(Records& to) {
  const std::uint64_t words[] = {chain_.surroundings().context, std::uint64_t(drawable_.extent.width),
                                 std::uint64_t(drawable_.extent.height), drawable_.number};
  to.append_plain(event::current, words);
}

void Remote::made_current() {
  if (!introduced_) introduce();
  drawable_ = server_.front().drawable();
  Records records;
  tell_current(records);
  server_.send(records);
}

void Remote::left() {
  if (has_front_to_show()) show_front_now();
  constexpr std::uint64_t nothing[] = {0, 0, 0};
  Records records;
  records.append_plain(event::current, nothing);
  server_.send(records);
}

/// Windows change their size without a call. Applications that notice it set a viewport; others draw the next
/// frame.
void Remote::note_drawable(Records& to) {
  const FrontDrawable now = server_.front().drawable();
  if (now.number == drawable_.number && now.extent == drawable_.extent) return;
  drawable_ = now;
  tell_current(to);
}

void Remote::show_frame() {
  pack_.hand_on();
  const std::uint64_t words[] = {++frames_, std::uint64_t(drawable_.extent.width),
                                 std::uint64_t(drawable_.extent.height)};
  Records records;
  records.append_plain(event::frame, words);
  server_.show_frame(records, drawable_);
  front_.shown();
  front_pending_ = false;
  records.clear();
  note_drawable(records);
  server_.send(records);
}

/// An off-screen surface has nothing to show.
bool Remote::has_front_to_show() {
  if (drawable_.number == 0 || drawable_.screen == 0) return false;
  return front_.is_drawn() || (front_pending_ && server_.is_front_pending(drawable_));
}

/// An application may flush after each triangle, and must not wait until each of them is visible. Returns false
/// if the image is pending.
bool Remote::show_front() {
  pack_.hand_on();
  front_pending_ = !server_.show_front(drawable_);
  front_.shown();
  return !front_pending_;
}

void Remote::show_front_now() {
  pack_.hand_on();
  server_.show_front_now(drawable_);
  front_.shown();
  front_pending_ = false;
}

void Remote::frame_ended(FrameEnd kind) {
  if (kind == FrameEnd::swap && drawable_.number != 0) show_frame();
  if (kind == FrameEnd::wait && has_front_to_show()) show_front_now();
  // Whatever the application then does to its windows by other means must come after its frames.
  if (kind == FrameEnd::wait) {
    pack_.hand_on();
    server_.wait_for_frames();
    refresh_mappings();
  }
}

void Remote::abandon() {
  const std::uint64_t words[] = {chain_.surroundings().context};
  Records records;
  records.append_plain(event::context_gone, words);
  server_.send(records);
}

std::optional<std::uint64_t> Remote::constant(CallId call, const std::uint64_t* words) const {
  if (is_text(call)) {
    const auto found = texts_.find({call, words_of_text(call, words)});
    if (found == texts_.end()) return std::nullopt;
    return reinterpret_cast<std::uintptr_t>(found->second);
  }
  if (!is_constant(call, words)) return std::nullopt;
  const auto found = constants_.find({call, words[0]});
  if (found == constants_.end() || words[1] == 0) return std::nullopt;
  std::memcpy(memory_at(words[1]), found->second.data(), found->second.size());
  return 0;
}

std::uint64_t Remote::lost_answer(CallId call, const std::uint64_t* words) const {
  // What was to be written into a buffer has no address.
  const bool into_buffer = std::string_view(call_name(call)).starts_with("glGetQueryObject") &&
                           state_.bound_buffer(GL_QUERY_BUFFER) != 0;
  return into_buffer ? 0 : answer_of_lost_context(call, words);
}

std::optional<std::uint64_t> Remote::known(CallId call, const std::uint64_t* words) {
  if (server_.lost()) return lost_answer(call, words);
  if (!answers(call)) return std::nullopt;
  if (call == CallId::GetError && without_error_) return GL_NO_ERROR;
  if (pack_.inside_begin()) return std::nullopt;
  if (call == CallId::GetBufferPointerv || call == CallId::GetBufferPointervARB ||
      call == CallId::GetNamedBufferPointerv || call == CallId::GetNamedBufferPointervEXT) {
    const auto found = mappings_.find(mapped_buffer(call, words));
    if (words[2] != 0)
      *reinterpret_cast<void**>(memory_at(words[2])) =
          found == mappings_.end() ? nullptr : found->second.memory.data();
    return 0;
  }
  if (is_integer_query(call) && GLenum(words[0]) == GL_DOUBLEBUFFER && words[1] != 0) {
    // On the GL server the window may have a single buffer.
    if (call == CallId::GetIntegerv) *reinterpret_cast<GLint*>(memory_at(words[1])) = context_.double_buffered;
    if (call == CallId::GetBooleanv)
      *reinterpret_cast<GLboolean*>(memory_at(words[1])) = context_.double_buffered;
    return 0;
  }
  std::uint64_t result = 0;
  if (state_.answer(call, words, Asker::application, result)) return result;
  if (call == CallId::GetStringi && GLenum(words[0]) == GL_EXTENSIONS) fetch_extensions();
  return constant(call, words);
}

/// Applications query one extension after another, which would take seconds over a connection with latency.
void Remote::fetch_extensions() {
  if (std::exchange(extensions_fetched_, true)) return;
  GLint count = 0;
  const std::uint64_t asked_count[] = {GL_NUM_EXTENSIONS, reinterpret_cast<std::uintptr_t>(&count)};
  ask(CallId::GetIntegerv, asked_count);
  count = std::clamp(count, 0, most_extensions);
  if (count == 0) return;
  pack_.hand_on();
  std::vector<std::array<std::uint64_t, 2>> calls;
  std::vector<Records> questions(static_cast<std::size_t>(count));
  for (Records& question : questions) {
    calls.push_back({GL_EXTENSIONS, calls.size()});
    question_encoder_.encode(CallId::GetStringi, calls.back().data(), question);
  }
  const std::vector<CallAnswer> answers = server_.ask_all(questions);
  for (std::size_t i = 0; i < answers.size(); ++i) apply({CallId::GetStringi, calls[i].data()}, answers[i]);
}

std::uint64_t Remote::ask(CallId call, const std::uint64_t* words) {
  if (call == CallId::ClientActiveTexture) {
    // The encoder queries the arrays of one texture unit after another, and restores the active unit.
    state_.note(call, words);
    return 0;
  }
  std::uint64_t result = 0;
  if (!server_.lost() && state_.answer(call, words, Asker::encoder, result)) return result;
  if (const auto answer = known(call, words)) return *answer;
  pack_.hand_on();
  question_records_.clear();
  question_encoder_.encode(call, words, question_records_);
  const PackedCall question{call, words};
  return take(question_records_, &question);
}

GLuint Remote::mapped_buffer(CallId call, const std::uint64_t* words) const {
  return is_by_name(call) ? GLuint(words[0]) : state_.bound_buffer(GLenum(words[0]));
}

void Remote::before(CallId call, const std::uint64_t* words, Records& to) {
  if (call != CallId::GetError) without_error_ = false;
  if (!pack_.inside_begin()) {
    if (call == CallId::Viewport && drawable_.number != 0) note_drawable(to);
    if (!mappings_.empty()) {
      writes_.before(chain_.driver(), call, words, to);
      drop_mappings(call, words);
    }
    if (call == CallId::Flush && front_.is_drawn() && has_front_to_show() && show_front()) note_drawable(to);
    if ((call == CallId::Finish || front_.is_left_by(call, words)) && has_front_to_show()) show_front_now();
  }
  state_.note(call, words);
  front_.note(call, words);
}

/// Drops the mappings that the call ends.
void Remote::drop_mappings(CallId call, const std::uint64_t* words) {
  if (deletes_buffers(call)) {
    for (const GLuint buffer : deleted_buffers(words)) mappings_.erase(buffer);
  } else if (unmaps_buffer(call)) {
    mappings_.erase(mapped_buffer(call, words));
  } else if (replaces_storage(call)) {
    const auto found = mappings_.find(mapped_buffer(call, words));
    if (found != mappings_.end() && !found->second.persistent) mappings_.erase(found);
  }
}

HandOn Remote::when(CallId call, bool inside_begin) {
  if (answers(call) || call == CallId::Finish) return HandOn::and_wait;
  return call == CallId::Flush && !inside_begin ? HandOn::now : HandOn::later;
}

std::uint64_t Remote::take(const Records& records, const PackedCall* last) {
  if (last == nullptr) {
    server_.send(records);
    return 0;
  }
  const std::optional<CallAnswer> answer = server_.ask(records);
  if (!answer) return lost_answer(last->call, last->words);
  const std::uint64_t result = apply(*last, *answer);
  if (has_waited(*last, result)) refresh_mappings();
  return result;
}

std::uint64_t Remote::apply(const PackedCall& call, const CallAnswer& answer) {
  std::uint64_t result = answer.result;
  for (const AnsweredOutput& output : answer.outputs) {
    switch (output.parameter) {
      case AnsweredOutput::result_text:
        result = keep_text(call, output);
        break;
      case AnsweredOutput::mapped:
        result = map(call, answer.result, output);
        break;
      case AnsweredOutput::feedback: {
        const ClientState::Retained& memory = state_.feedback();
        if (memory.first != 0)
          std::memcpy(memory_at(memory.first), output.bytes.data(),
                      std::min(memory.bytes, output.bytes.size()));
        break;
      }
      default:
        write_output(call, output);
    }
  }
  // Addresses in the GL server's process are meaningless here.
  if (call_shape(call.call).result_pointer != 0 && answer.outputs.empty()) return 0;
  if (call.call == CallId::GetError) without_error_ = result == GL_NO_ERROR;
  return result;
}

void Remote::write_output(const PackedCall& call, const AnsweredOutput& output) {
  const auto parameters = call_shape(call.call).parameters();
  if (output.parameter >= parameters.size()) return;
  const ParameterShape& parameter = parameters[output.parameter];
  const std::uint64_t to = call.words[output.parameter];
  if (parameter.pointer == 0 || parameter.input || to == 0) return;
  if (output.image) {
    const auto needed = image_extent(*output.image, tight_pixels);
    if (parameter.rule == ExtentRule::image_out && needed && *needed <= output.bytes.size())
      spread_image(*output.image, state_.pack(), output.bytes.data(), memory_at(to));
    return;
  }
  const std::size_t room =
      parameter.rule == ExtentRule::image_out
          ? output.bytes.size()
          : pointee_bytes(call.call, output.parameter, call.words).value_or(most_unknown_bytes);
  const std::size_t bytes = std::min(room, output.bytes.size());
  std::memcpy(memory_at(to), output.bytes.data(), bytes);
  if (is_constant(call.call, call.words))
    constants_[{call.call, call.words[0]}].assign(output.bytes.begin(),
                                                  output.bytes.begin() + std::ptrdiff_t(bytes));
}

std::uint64_t Remote::keep_text(const PackedCall& call, const AnsweredOutput& output) {
  const auto* first = reinterpret_cast<const char*>(output.bytes.data());
  const char* text = server_.keep_text(std::string(first, strnlen(first, output.bytes.size())));
  if (is_text(call.call)) texts_[{call.call, words_of_text(call.call, call.words)}] = text;
  return reinterpret_cast<std::uintptr_t>(text);
}

std::uint64_t Remote::map(const PackedCall& call, std::uint64_t bytes, const AnsweredOutput& contents) {
  // The GL server has mapped this many bytes, so they are at most the size of the application's buffer.
  const CallShape& shape = call_shape(call.call);
  const std::uint8_t length = argument_named(shape, "length");
  Mapping& mapping = mappings_[mapped_buffer(call.call, call.words)];
  mapping = {.bytes = bytes};
  if (length != no_argument) {
    const auto access = GLbitfield(call.words[argument_named(shape, "access")]);
    mapping.offset = call.words[argument_named(shape, "offset")];
    mapping.bytes = std::max(bytes, call.words[length]);
    mapping.persistent = (access & GL_MAP_PERSISTENT_BIT) != 0;
    mapping.is_read = (access & GL_MAP_READ_BIT) != 0;
  }
  mapping.memory.assign(std::size_t(mapping.bytes) / sizeof(std::max_align_t) + 1, {});
  if (!contents.bytes.empty())
    std::memcpy(mapping.memory.data(), contents.bytes.data(),
                std::min<std::size_t>(mapping.bytes, contents.bytes.size()));
  const std::uint64_t first = reinterpret_cast<std::uintptr_t>(mapping.memory.data());
  // Sends the address by which the following writes will refer to the mapping.
  const std::uint64_t words[] = {stable_id(call.call), first};
  Records records;
  records.append_plain(event::answers, words);
  server_.send(records);
  writes_.after(chain_.driver(), call.call, call.words, first);
  return first;
}

/// Fetches what OpenGL has written into persistent mappings that the application reads.
void Remote::refresh_mappings() {
  const auto is_refreshed = [](const auto& entry) { return entry.second.persistent && entry.second.is_read; };
  if (std::ranges::none_of(mappings_, is_refreshed)) return;
  // The application's writes so far must be in the buffers, or they would be overwritten.
  Records writes;
  writes_.append_persistent(chain_.driver(), writes);
  server_.send(writes);
  for (auto& entry : mappings_) {
    if (!is_refreshed(entry)) continue;
    auto& [buffer, mapping] = entry;
    const std::vector<std::byte> contents = contents_of(buffer, mapping);
    if (!contents.empty() && !writes_.refresh(buffer, contents))
      std::memcpy(mapping.memory.data(), contents.data(), contents.size());
  }
}

/// What the mapped part of a buffer contains on the GL server; empty if the GL server does not answer.
std::vector<std::byte> Remote::contents_of(GLuint buffer, const Mapping& mapping) {
  constexpr GLenum target = GL_COPY_READ_BUFFER;
  std::vector<std::byte> contents;
  Records records;
  const auto bind = [&](GLuint bound) {
    const std::uint64_t words[] = {target, bound};
    records.append_plain(stable_id(CallId::BindBuffer), words);
  };
  bind(buffer);
  while (contents.size() < mapping.bytes) {
    const std::uint64_t bytes = std::min(mapping.bytes - contents.size(), most_refreshed_bytes);
    const std::uint64_t words[] = {target, mapping.offset + contents.size(), bytes, somewhere};
    question_encoder_.encode(CallId::GetBufferSubData, words, records);
    const std::optional<CallAnswer> answer = server_.ask(records);
    records.clear();
    if (!answer || answer->outputs.empty() || answer->outputs[0].bytes.size() != bytes) break;
    contents.insert(contents.end(), answer->outputs[0].bytes.begin(), answer->outputs[0].bytes.end());
  }
  bind(state_.bound_buffer(target));
  server_.send(records);
  if (contents.size() < mapping.bytes) contents.clear();
  return contents;
}

constinit const UnitDescription remote_description{
    .name = "remote",
    .help = "executes the calls on a GL server (understudy run --remote)",
    .position = UnitPosition::last,
    .needs = "pack",
    .make = [](const UnitPlace& place) -> std::unique_ptr<Unit> {
      ServerConnection* server = place.chain.surroundings().server;
      if (server == nullptr)
        throw ChainError("remote",
                         "there is no GL server; start the viewer with: understudy run --remote -- viewer");
      return std::make_unique<Remote>(place.chain, *server);
    }};

}  // namespace understudy::spu
