// SPDX-License-Identifier: Apache-2.0
#include "spu/track/answers.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string_view>
#include <type_traits>

#include "dispatch/call_shape.h"
#include "dispatch/pass_through.h"
#include "spu/track/track.h"

namespace understudy::spu {
namespace {

/// The topics that a query's answer depends on, and its minimum number of values.
struct Subject {
  StateTopics topics = topic::nothing;
  int count = 1;
};

constexpr GLenum constants[] = {GL_MAJOR_VERSION,
                                GL_MINOR_VERSION,
                                GL_NUM_EXTENSIONS,
                                GL_CONTEXT_FLAGS,
                                GL_CONTEXT_PROFILE_MASK,
                                GL_SUBPIXEL_BITS,
                                GL_ALIASED_POINT_SIZE_RANGE,
                                GL_ALIASED_LINE_WIDTH_RANGE,
                                GL_SMOOTH_POINT_SIZE_RANGE,
                                GL_SMOOTH_POINT_SIZE_GRANULARITY,
                                GL_SMOOTH_LINE_WIDTH_RANGE,
                                GL_SMOOTH_LINE_WIDTH_GRANULARITY,
                                GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT,
                                GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT,
                                GL_TEXTURE_BUFFER_OFFSET_ALIGNMENT,
                                GL_MIN_MAP_BUFFER_ALIGNMENT,
                                GL_MIN_PROGRAM_TEXEL_OFFSET,
                                GL_NUM_SHADING_LANGUAGE_VERSIONS};

/// Whether the answer is restricted to the bits or clamped to the range of the framebuffer, whose attachments
/// are shared objects.
bool depends_on_framebuffer(GLenum name) {
  constexpr std::array<GLenum, 8> names = {
      GL_STENCIL_REF, GL_STENCIL_BACK_REF, GL_COLOR_CLEAR_VALUE, GL_BLEND_COLOR,
      GL_FOG_COLOR,   GL_ALPHA_TEST_REF,   GL_CURRENT_COLOR,     GL_CURRENT_SECONDARY_COLOR};
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The subjects of all rows of state, by the name of the query.
std::unordered_map<GLenum, Subject> subjects_of_rows() {
  std::unordered_map<GLenum, Subject> subjects;
  for (const StateRow& row : state_rows()) {
    // A framebuffer object may belong to another context too.
    if (row.group == StateGroup::of_framebuffer) continue;
    switch (row.question) {
      case Question::light:
      case Question::material:
      case Question::texture_env:
      case Question::texture_gen:
      case Question::clip_plane:
      case Question::vertex_attribute:
        continue;
      default:
        break;
    }
    for (const StateQuery& query : row.queries) {
      if (query.count == 0 || depends_on_framebuffer(query.name)) continue;
      Subject& subject = subjects[query.name];
      subject.topics |= topics_of(row);
      subject.count = std::max(subject.count, row.from_value + query.count);
    }
    // glIsEnabled(GL_CLIP_PLANE0 + i).
    if (row.question == Question::enabled && row.numbered) {
      for (GLenum i = 1; i < 8; ++i) subjects[row.first_number + i] = {topics_of(row), 1};
    }
  }
  for (const GLenum name : constants) subjects[name] = {};
  return subjects;
}

std::optional<Subject> subject_of(GLenum name) {
  static const std::unordered_map<GLenum, Subject> subjects = subjects_of_rows();
  if (const auto found = subjects.find(name); found != subjects.end()) return found->second;
  // Limits of the implementation.
  const char* text = enum_name(name, 0);
  if (text != nullptr && std::string_view(text).starts_with("GL_MAX_")) return Subject{};
  return std::nullopt;
}

/// A value that no driver returns, which marks what was not written.
template <class T>
constexpr T never_answered() {
  if constexpr (std::is_floating_point_v<T>) {
    return T(-7.61937e29);
  } else if constexpr (sizeof(T) == 1) {
    return T(0x5a);
  } else {
    return std::numeric_limits<T>::min() + 0x2a5a5a5;
  }
}

struct NoteChange {
  [[gnu::noinline]] static const DispatchTable& before(CallId call) {
    Track& track = Track::current();
    Answers& answers = *track.answers();
    answers.changed(topics_changed_by(call));
    const DispatchTable* own = answers.own(track.chain().phase(), call);
    return own != nullptr ? *own : track.below();
  }
};

/// For commands that change more than their topics.
struct NoteBegin {
  static const DispatchTable& before(CallId call) {
    Track::current().answers()->perhaps_inside_begin();
    return NoteChange::before(call);
  }
};

struct NoteEnd {
  static const DispatchTable& before(CallId call) {
    Track::current().answers()->outside_begin();
    return NoteChange::before(call);
  }
};

void APIENTRY call_list(GLuint list) {
  Track& track = Track::current();
  Answers& answers = *track.answers();
  const auto record = track.chain().group().list(list);
  answers.changed(record && record->only_geometry ? topic::current : topic::everything);
  answers.perhaps_inside_begin();
  const DispatchTable* own = answers.own(track.chain().phase(), CallId::CallList);
  (own != nullptr ? *own : track.below()).CallList(list);
}

template <CallId Query, auto Slot>
struct Values;
template <CallId Query, class T, void (APIENTRY* DispatchTable::*Slot)(GLenum, T*)>
struct Values<Query, Slot> {
  static void APIENTRY call(GLenum name, T* to) {
    Track& track = Track::current();
    track.answers()->values(Query, name, 0, to, [&](T* v) { (track.below().*Slot)(name, v); });
  }
};
template <CallId Query, class T, void (APIENTRY* DispatchTable::*Slot)(GLenum, GLuint, T*)>
struct Values<Query, Slot> {
  static void APIENTRY call(GLenum name, GLuint index, T* to) {
    Track& track = Track::current();
    track.answers()->values(Query, name, index, to, [&](T* v) { (track.below().*Slot)(name, index, v); });
  }
};

GLboolean APIENTRY is_enabled(GLenum name) {
  const DispatchTable& below = Track::current().below();
  return Track::current().answers()->enabled(
      CallId::IsEnabled, name, 0, [&] { return below.IsEnabled(name); },
      [&](GLboolean* value) { below.GetBooleanv(name, value); });
}

GLboolean APIENTRY is_enabled_indexed(GLenum name, GLuint index) {
  const DispatchTable& below = Track::current().below();
  return Track::current().answers()->enabled(
      CallId::IsEnabledi, name, index, [&] { return below.IsEnabledi(name, index); },
      [&](GLboolean* value) { below.GetBooleani_v(name, index, value); });
}

const GLubyte* APIENTRY get_string(GLenum name) {
  return Track::current().answers()->text(CallId::GetString, name, 0,
                                          [&] { return Track::current().below().GetString(name); });
}

const GLubyte* APIENTRY get_string_indexed(GLenum name, GLuint index) {
  return Track::current().answers()->text(CallId::GetStringi, name, index,
                                          [&] { return Track::current().below().GetStringi(name, index); });
}

void fill_queries(DispatchTable& table) {
  using Table = DispatchTable;
  table.GetBooleanv = Values<CallId::GetBooleanv, &Table::GetBooleanv>::call;
  table.GetIntegerv = Values<CallId::GetIntegerv, &Table::GetIntegerv>::call;
  table.GetInteger64v = Values<CallId::GetInteger64v, &Table::GetInteger64v>::call;
  table.GetFloatv = Values<CallId::GetFloatv, &Table::GetFloatv>::call;
  table.GetDoublev = Values<CallId::GetDoublev, &Table::GetDoublev>::call;
  table.GetBooleani_v = Values<CallId::GetBooleani_v, &Table::GetBooleani_v>::call;
  table.GetIntegeri_v = Values<CallId::GetIntegeri_v, &Table::GetIntegeri_v>::call;
  table.GetInteger64i_v = Values<CallId::GetInteger64i_v, &Table::GetInteger64i_v>::call;
  table.GetFloati_v = Values<CallId::GetFloati_v, &Table::GetFloati_v>::call;
  table.GetDoublei_v = Values<CallId::GetDoublei_v, &Table::GetDoublei_v>::call;
  table.IsEnabled = is_enabled;
  table.IsEnabledi = is_enabled_indexed;
  table.GetString = get_string;
  table.GetStringi = get_string_indexed;
}

}  // namespace

void Answers::fill(Phase phase, DispatchTable& table, const DispatchTable& next) {
  std::unique_ptr<Own>& own = own_[std::size_t(phase)];
  if (!own) own = std::make_unique<Own>();
  own->table = table;
  DispatchTable noting = table;
  PassThrough<NoteChange>::fill(noting);
  for (std::size_t i = 0; i < call_count; ++i) {
    const auto call = CallId(i);
    own->overridden[i] = slot(table, call) != slot(next, call);
    if (topics_changed_by(call) != topic::nothing) set_slot(table, call, slot(noting, call));
  }
  table.Begin = PassThrough<NoteBegin>::glBegin;
  table.End = PassThrough<NoteEnd>::glEnd;
  table.CallList = call_list;
  table.CallLists = PassThrough<NoteBegin>::glCallLists;
  fill_queries(table);
}

const DispatchTable* Answers::own(Phase phase, CallId call) const {
  const Own& own = *own_[std::size_t(phase)];
  return own.overridden[std::size_t(call)] ? &own.table : nullptr;
}

const Answers::Answer* Answers::find(const Query& query) {
  if (changed_ != topic::nothing) {
    ++now_;
    for (StateTopics rest = changed_; rest != 0; rest &= rest - 1)
      changed_at_[std::size_t(std::countr_zero(rest))] = now_;
    changed_ = topic::nothing;
  }
  if (!known_outside_begin_) return nullptr;
  const auto found = answers_.find(query);
  if (found == answers_.end()) return nullptr;
  for (StateTopics rest = found->second.topics; rest != 0; rest &= rest - 1) {
    if (changed_at_[std::size_t(std::countr_zero(rest))] > found->second.asked_at) return nullptr;
  }
  return &found->second;
}

void Answers::keep(const Query& query, StateTopics topics, const void* bytes, std::size_t size) {
  Answer& answer = answers_[query];
  answer.topics = topics;
  answer.asked_at = now_;
  answer.size = size;
  std::memcpy(answer.bytes.data(), bytes, size);
}

template <class T, class Ask>
void Answers::values(CallId call, GLenum name, GLuint index, T* to, Ask ask) {
  const Query query{call, name, index};
  if (const Answer* answer = find(query)) {
    std::memcpy(to, answer->bytes.data(), answer->size);
    return;
  }
  const std::optional<Subject> subject = subject_of(name);
  if (!subject) return ask(to);
  std::array<T, 2 * std::size_t(max_state_values)> answered{};
  answered.fill(never_answered<T>());
  ask(answered.data());
  std::size_t count = max_state_values;
  while (count > 0 && answered[count - 1] == never_answered<T>()) --count;
  // Rejected, as between glBegin and glEnd; or the answer happens to be this very value.
  if (count == 0) return ask(to);
  count = std::max(count, std::size_t(subject->count));
  known_outside_begin_ = true;
  keep(query, subject->topics, answered.data(), count * sizeof(T));
  std::memcpy(to, answered.data(), count * sizeof(T));
}

template <class Ask, class IsKnown>
GLboolean Answers::enabled(CallId call, GLenum name, GLuint index, Ask ask, IsKnown is_known) {
  const Query query{call, name, index};
  if (const Answer* answer = find(query)) return GLboolean(answer->bytes[0]);
  const GLboolean is = ask();
  const std::optional<Subject> subject = subject_of(name);
  if (!subject) return is;
  // GL_FALSE is also the result after an error; another query of the name raises the same error once more.
  GLboolean value = is;
  if (is == GL_FALSE) {
    value = never_answered<GLboolean>();
    is_known(&value);
  }
  if (value != is) return is;
  known_outside_begin_ = true;
  keep(query, subject->topics, &is, sizeof is);
  return is;
}

template <class Ask>
const GLubyte* Answers::text(CallId call, GLenum name, GLuint index, Ask ask) {
  const Query query{call, name, index};
  if (const Answer* answer = find(query)) {
    const GLubyte* text = nullptr;
    std::memcpy(&text, answer->bytes.data(), sizeof text);
    return text;
  }
  const GLubyte* text = ask();
  static constexpr std::array<GLenum, 5> fixed = {GL_VENDOR, GL_RENDERER, GL_VERSION, GL_EXTENSIONS,
                                                  GL_SHADING_LANGUAGE_VERSION};
  if (text != nullptr && std::find(fixed.begin(), fixed.end(), name) != fixed.end())
    keep(query, topic::nothing, static_cast<const void*>(&text), sizeof text);
  return text;
}

}  // namespace understudy::spu
