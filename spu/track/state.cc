// SPDX-License-Identifier: Apache-2.0
#include "spu/track/state.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <string_view>

#include "dispatch/call_shape.h"
#include "dispatch/call_words.h"

namespace understudy::spu {
namespace {

using StateValues = std::span<const double>;

bool equal(StateValues a, StateValues b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

class StateReader {
 public:
  explicit StateReader(const DispatchTable& gl) : gl_(gl), version_(read_version()), core_(is_core()) {}

  State read() {
    State state;
    state.set_core(core_);
    const double unit = selected(GL_ACTIVE_TEXTURE, 130);
    const double client_unit = core_ ? 0 : selected(GL_CLIENT_ACTIVE_TEXTURE, 130);
    for (const StateRow& row : state_rows()) {
      if (version_ < row.from_version || version_ >= row.below_version ||
          (core_ ? row.compatibility : row.core))
        continue;
      const GLuint count = count_of(row.per);
      // Generic attribute 0 of a compatibility context is the vertex itself.
      const bool no_first = !core_ && row.set == CallId::VertexAttrib4f;
      for (GLuint number = no_first ? 1 : 0; number < count; ++number) {
        if (row.group == StateGroup::selectors) continue;
        select(row.selector, number);
        read(row, number, state.add(row, number));
      }
      if (row.set == CallId::ActiveTexture) state.add(row, 0)[0] = unit;
      if (row.set == CallId::ClientActiveTexture) state.add(row, 0)[0] = client_unit;
      if (row.set == CallId::MatrixMode) read(row, 0, state.add(row, 0));
    }
    if (version_ >= 130) {
      gl_.ActiveTexture(GLenum(unit));
      if (!core_) gl_.ClientActiveTexture(GLenum(client_unit));
    }
    return state;
  }

 private:
  int read_version() const {
    const auto* text = reinterpret_cast<const char*>(gl_.GetString(GL_VERSION));
    if (text == nullptr) return 0;
    char* rest = nullptr;
    const long major = std::strtol(text, &rest, 10);
    const long minor = *rest == '.' ? std::strtol(rest + 1, nullptr, 10) : 0;
    return int(100 * major + 10 * minor);
  }
  bool is_core() const {
    if (version_ >= 320) return (integer(GL_CONTEXT_PROFILE_MASK) & GL_CONTEXT_CORE_PROFILE_BIT) != 0;
    if (version_ < 310) return false;
    const GLint count = integer(GL_NUM_EXTENSIONS);
    for (GLint i = 0; i < count; ++i) {
      const auto* name = reinterpret_cast<const char*>(gl_.GetStringi(GL_EXTENSIONS, GLuint(i)));
      if (name != nullptr && std::string_view(name) == "GL_ARB_compatibility") return false;
    }
    return true;
  }
  GLint integer(GLenum name) const {
    GLint value = 0;
    gl_.GetIntegerv(name, &value);
    return value;
  }
  double selected(GLenum name, int from_version) const {
    return version_ >= from_version ? integer(name) : GL_TEXTURE0;
  }

  GLuint count_of(Per per) const {
    const bool units = version_ >= 130;
    switch (per) {
      case Per::context:
        return 1;
      case Per::light:
        return GLuint(integer(GL_MAX_LIGHTS));
      case Per::clip_plane:
        return GLuint(integer(GL_MAX_CLIP_PLANES));
      case Per::texture_coordinates:
        if (!units) return 1;
        return GLuint(integer(version_ >= 200 ? GL_MAX_TEXTURE_COORDS : GL_MAX_TEXTURE_UNITS));
      case Per::texture_unit:
        if (!units) return 1;
        return GLuint(integer(version_ >= 200 ? GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS : GL_MAX_TEXTURE_UNITS));
      case Per::draw_buffer:
        return GLuint(integer(GL_MAX_DRAW_BUFFERS));
      case Per::viewport:
        return GLuint(integer(GL_MAX_VIEWPORTS));
      case Per::vertex_attribute:
        return GLuint(integer(GL_MAX_VERTEX_ATTRIBS));
      case Per::sample_mask:
        return GLuint(integer(GL_MAX_SAMPLE_MASK_WORDS));
      case Per::uniform_buffer:
        return GLuint(integer(GL_MAX_UNIFORM_BUFFER_BINDINGS));
      case Per::storage_buffer:
        return GLuint(integer(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS));
      case Per::counter_buffer:
        return GLuint(integer(GL_MAX_ATOMIC_COUNTER_BUFFER_BINDINGS));
    }
    return 0;
  }

  void select(Selector selector, GLuint number) const {
    if (version_ < 130) return;
    if (selector == Selector::texture_unit) gl_.ActiveTexture(GL_TEXTURE0 + number);
    if (selector == Selector::client_texture_unit) gl_.ClientActiveTexture(GL_TEXTURE0 + number);
  }

  template <class T, class Ask>
  static void answer(std::span<double> to, int from, Ask ask) {
    std::array<T, max_state_values> values{};
    ask(values.data());
    std::copy_n(values.begin() + from, to.size(), to.begin());
  }

  void read(const StateRow& row, GLuint number, std::span<double> values) const {
    for (const StateQuery& query : row.queries) {
      if (query.count == 0) break;
      ask(row, query.name, number, values.first(std::size_t(query.count)));
      values = values.subspan(std::size_t(query.count));
    }
  }

  void ask(const StateRow& row, GLenum name, GLuint number, std::span<double> to) const {
    const GLenum of = row.first_number + number;
    const int from = row.from_value;
    switch (row.question) {
      case Question::value:
        return answer<GLdouble>(to, from, [&](GLdouble* v) { gl_.GetDoublev(name, v); });
      case Question::enabled:
        to[0] = gl_.IsEnabled(row.numbered ? of : name);
        return;
      case Question::enabled_indexed:
        to[0] = gl_.IsEnabledi(name, number);
        return;
      case Question::integer_indexed:
        return answer<GLint>(to, from, [&](GLint* v) { gl_.GetIntegeri_v(name, number, v); });
      case Question::address_indexed:
        return answer<GLint64>(to, from, [&](GLint64* v) { gl_.GetInteger64i_v(name, number, v); });
      case Question::float_indexed:
        return answer<GLfloat>(to, from, [&](GLfloat* v) { gl_.GetFloati_v(name, number, v); });
      case Question::double_indexed:
        return answer<GLdouble>(to, from, [&](GLdouble* v) { gl_.GetDoublei_v(name, number, v); });
      case Question::light:
        return answer<GLfloat>(to, from, [&](GLfloat* v) { gl_.GetLightfv(of, name, v); });
      case Question::material:
        return answer<GLfloat>(to, from, [&](GLfloat* v) { gl_.GetMaterialfv(row.target, name, v); });
      case Question::texture_env:
        return answer<GLfloat>(to, from, [&](GLfloat* v) { gl_.GetTexEnvfv(row.target, name, v); });
      case Question::texture_gen:
        return answer<GLdouble>(to, from, [&](GLdouble* v) { gl_.GetTexGendv(row.target, name, v); });
      case Question::clip_plane:
        return answer<GLdouble>(to, from, [&](GLdouble* v) { gl_.GetClipPlane(of, v); });
      case Question::vertex_attribute:
        return answer<GLdouble>(to, from, [&](GLdouble* v) { gl_.GetVertexAttribdv(number, name, v); });
    }
  }

  const DispatchTable& gl_;
  const int version_;
  const bool core_;
};

/// Calls `take` with the value in a parameter's type.
template <class Take>
auto with_type(ValueType type, double value, Take take) {
  switch (type) {
    case ValueType::float32:
      return take(GLfloat(value));
    case ValueType::float64:
      return take(value);
    case ValueType::boolean:
    case ValueType::uint8:
      return take(GLubyte(value));
    case ValueType::uint16:
      return take(GLushort(value));
    case ValueType::enumeration:
    case ValueType::bitfield:
    case ValueType::uint32:
      // Queries return masks as negative numbers.
      return take(GLuint(std::int64_t(value)));
    case ValueType::int32:
      return take(GLint(value));
    default:
      return take(std::int64_t(value));
  }
}

/// Writes calls, and updates `now_`, the state after them.
class Difference {
 public:
  Difference(State from, const State& to) : now_(std::move(from)), to_(to) {}

  Records write() {
    if (now_ == to_) return {};
    free_the_material();
    bool framebuffer_changes = false;
    bool vertex_array_changes = false;
    for (const State::Item& wanted : to_.items()) {
      const StateRow& row = *wanted.row;
      const State::Item* item = counterpart(wanted);
      if (item == nullptr) continue;
      const bool differs = !equal(now_.values(*item), to_.values(wanted));
      if (row.group == StateGroup::framebuffer) framebuffer_changes |= differs;
      if (row.group == StateGroup::vertex_array) vertex_array_changes |= differs;
      // The state of a newly bound object is unknown.
      const bool unknown =
          (row.group == StateGroup::of_framebuffer && framebuffer_changes) ||
          (row.group == StateGroup::of_vertex_array && vertex_array_changes &&
           !(to_.core() && value_of(to_, CallId::BindVertexArray, GL_VERTEX_ARRAY_BINDING) == 0));
      // The driver returns the reference value with only as many bits as the framebuffer has.
      const bool cut = row.set == CallId::StencilFuncSeparate && framebuffer_changes;
      if (differs || unknown || cut) set(*item, to_.values(wanted));
    }
    return std::move(records_);
  }

 private:
  /// Finds the same item in now_; both states are in the order of the rows.
  const State::Item* counterpart(const State::Item& wanted) {
    const auto items = now_.items();
    const auto before = [](const State::Item& a, const State::Item& b) {
      return a.row != b.row ? a.row < b.row : a.number < b.number;
    };
    while (position_ < items.size() && before(items[position_], wanted)) ++position_;
    if (position_ == items.size() || before(wanted, items[position_])) return nullptr;
    return &items[position_];
  }

  static double value_of(const State& state, CallId set, GLenum name) {
    const State::Item* item = state.find(set, name);
    return item == nullptr ? 0 : state.values(*item)[0];
  }

  /// Disables GL_COLOR_MATERIAL if needed: while it is enabled, the current colour and glColorMaterial change
  /// the material.
  void free_the_material() {
    const State::Item* enabled = now_.find(CallId::Enable, GL_COLOR_MATERIAL);
    if (enabled == nullptr || now_.values(*enabled)[0] == 0) return;
    const bool touched = std::any_of(to_.items().begin(), to_.items().end(), [&](const State::Item& wanted) {
      const CallId call = wanted.row->set;
      if (call != CallId::Materialfv && call != CallId::ColorMaterial && call != CallId::Color4f) return false;
      const State::Item* item = now_.find(call, wanted.row->queries[0].name, 0, wanted.row->target);
      return item != nullptr && !equal(now_.values(*item), to_.values(wanted));
    });
    if (touched) set(*enabled, std::array{0.0});
  }

  void set(const State::Item& item, StateValues values) {
    const StateRow& row = *item.row;
    // Calls with a unit argument need no selected unit.
    if (row.selector == Selector::texture_unit && !row.numbered)
      select(CallId::ActiveTexture, GL_ACTIVE_TEXTURE, item.number);
    if (row.selector == Selector::client_texture_unit)
      select(CallId::ClientActiveTexture, GL_CLIENT_ACTIVE_TEXTURE, item.number);
    if (row.matrix_mode != 0) select_matrix(row.matrix_mode);
    if (row.group == StateGroup::eye_space) load_identity();
    switch (row.set) {
      case CallId::Enable:
      case CallId::Enablei:
      case CallId::EnableClientState:
      case CallId::EnableVertexAttribArray:
        switch_to(item, values[0] != 0);
        break;
      case CallId::DrawBuffers:
        set_draw_buffers(values);
        break;
      case CallId::BindBufferRange:
        bind_indexed(item, values);
        break;
      case CallId::BindProgramPipeline:
        use_no_program();
        call(row.set, {}, values);
        break;
      default:
        call(row.set, arguments_before(item), values);
    }
    std::copy(values.begin(), values.end(), now_.values(item).begin());
  }

  static std::vector<double> arguments_before(const State::Item& item) {
    std::vector<double> arguments;
    const StateRow& row = *item.row;
    if (row.target != 0) arguments.push_back(row.target);
    if (row.numbered) arguments.push_back(row.first_number + item.number);
    if (row.named) arguments.push_back(row.queries[0].name);
    return arguments;
  }

  void switch_to(const State::Item& item, bool on) {
    const StateRow& row = *item.row;
    const double name = row.queries[0].name;
    switch (row.set) {
      case CallId::Enablei:
        return call(on ? CallId::Enablei : CallId::Disablei, std::array{name, double(item.number)}, {});
      case CallId::EnableClientState:
        return call(on ? CallId::EnableClientState : CallId::DisableClientState, std::array{name}, {});
      case CallId::EnableVertexAttribArray:
        return call(on ? CallId::EnableVertexAttribArray : CallId::DisableVertexAttribArray,
                    std::array{double(item.number)}, {});
      default:
        return call(on ? CallId::Enable : CallId::Disable,
                    std::array{row.numbered ? double(row.first_number + item.number) : name}, {});
    }
  }

  /// One draw buffer of the default framebuffer may stand for several, which glDrawBuffers does not accept.
  void set_draw_buffers(StateValues values) {
    std::size_t used = values.size();
    while (used > 1 && values[used - 1] == GL_NONE) --used;
    if (used == 1) return call(CallId::DrawBuffer, {}, values.first(1));
    call(CallId::DrawBuffers, std::array{double(used)}, values.first(used));
  }

  void bind_indexed(const State::Item& item, StateValues values) {
    const std::vector<double> before = arguments_before(item);
    if (values[2] == 0) {
      call(CallId::BindBufferBase, before, values.first(1));
    } else {
      call(CallId::BindBufferRange, before, values);
    }
    if (const State::Item* target = now_.find(CallId::BindBuffer, item.row->queries[0].name)) {
      now_.values(*target)[0] = values[0];
    }
  }

  /// Mesa does not unbind a pipeline while a program is in use. The wanted program is set afterwards.
  void use_no_program() {
    const State::Item* program = now_.find(CallId::UseProgram, GL_CURRENT_PROGRAM);
    if (program == nullptr || now_.values(*program)[0] == 0) return;
    call(CallId::UseProgram, {}, std::array{0.0});
    now_.values(*program)[0] = 0;
  }

  void select(CallId selector, GLenum name, GLuint number) {
    const State::Item* item = now_.find(selector, name);
    const double wanted = GL_TEXTURE0 + number;
    if (item == nullptr || now_.values(*item)[0] == wanted) return;
    call(selector, {}, std::array{wanted});
    now_.values(*item)[0] = wanted;
  }

  void select_matrix(GLenum mode) {
    const State::Item* item = now_.find(CallId::MatrixMode, GL_MATRIX_MODE);
    if (item == nullptr || now_.values(*item)[0] == mode) return;
    call(CallId::MatrixMode, {}, std::array{double(mode)});
    now_.values(*item)[0] = mode;
  }

  void load_identity() {
    constexpr std::array<double, 16> identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const State::Item* item = now_.find(CallId::LoadMatrixd, GL_MODELVIEW_MATRIX);
    if (item == nullptr || equal(now_.values(*item), identity)) return;
    call(CallId::LoadMatrixd, {}, identity);
    std::copy(identity.begin(), identity.end(), now_.values(*item).begin());
  }

  /// Appends a call: all values go to its pointer parameter, or one value to each parameter.
  void call(CallId id, StateValues before, StateValues values) {
    records_.begin(stable_id(id));
    const auto parameters = call_shape(id).parameters();
    for (std::size_t p = 0; p < parameters.size(); ++p) records_.append(0);
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      const ParameterShape& parameter = parameters[p];
      if (parameter.pointer != 0) {
        records_.set(p + 1, attach(parameter.type, values).word());
        return;
      }
      StateValues& next = before.empty() ? values : before;
      records_.set(p + 1, with_type(parameter.type, next[0], [](auto v) { return word(v); }));
      next = next.subspan(1);
    }
  }

  Reference attach(ValueType type, StateValues values) {
    std::vector<std::byte> bytes;
    for (const double value : values) {
      with_type(type, value, [&](auto v) {
        const auto part = std::as_bytes(std::span(&v, 1));
        bytes.insert(bytes.end(), part.begin(), part.end());
        return 0;
      });
    }
    return records_.attach(bytes);
  }

  State now_;
  const State& to_;
  Records records_;
  std::size_t position_ = 0;  ///< in the items of now_
};

}  // namespace

const State::Item* State::find(CallId set, GLenum name, GLuint number, GLenum target) const {
  const auto found = std::find_if(items_.begin(), items_.end(), [&](const Item& item) {
    return item.row->set == set && item.row->queries[0].name == name && item.number == number &&
           (target == 0 || item.row->target == target);
  });
  return found == items_.end() ? nullptr : &*found;
}

std::span<double> State::add(const StateRow& row, GLuint number) {
  items_.push_back({&row, number, values_.size()});
  values_.resize(values_.size() + std::size_t(row.count()));
  return values(items_.back());
}

bool State::operator==(const State& other) const {
  return core_ == other.core_ && equal(values_, other.values_) &&
         std::equal(items_.begin(), items_.end(), other.items_.begin(), other.items_.end(),
                    [](const Item& a, const Item& b) { return a.row == b.row && a.number == b.number; });
}

State read_state(const DispatchTable& gl) {
  return StateReader(gl).read();
}

Records difference(const State& from, const State& to) {
  return Difference(from, to).write();
}

}  // namespace understudy::spu
