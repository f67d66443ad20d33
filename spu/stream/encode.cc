// SPDX-License-Identifier: Apache-2.0
#include "spu/stream/encode.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <string_view>
#include <variant>

#include "spu/stream/bound_buffers.h"
#include "spu/stream/event.h"
#include "spu/stream/extent.h"
#include "spu/stream/pixels.h"
#include "spu/stream/plain_calls.h"
#include "spu/stream/pointer_words.h"

namespace understudy::spu {

namespace {}  // namespace

bool needs_answer(CallId call) noexcept {
  const CallShape& shape = call_shape(call);
  if (shape.result != ValueType::none) return true;
  for (const ParameterShape& parameter : shape.parameters()) {
    if (parameter.pointer == 0) continue;
    if (!parameter.input || parameter.rule == ExtentRule::unknown || parameter.rule == ExtentRule::address)
      return true;
  }
  return false;
}

Encoder::Encoder(const DispatchTable& questions, std::function<void()> before_question)
    : questions_(questions), before_question_(std::move(before_question)) {
  arguments_.reserve(max_parameters);
}

const DispatchTable& Encoder::ask() {
  before_question_();
  return questions_;
}

std::uint64_t Encoder::told(std::uint64_t address) const {
  return hides_addresses_ && address != 0 ? somewhere : address;
}

GLint Encoder::ask(GLenum name) {
  GLint value = 0;
  ask().GetIntegerv(name, &value);
  return value;
}

void Encoder::follow_begin_and_end(CallId call, const std::uint64_t* words, Records& to) {
  const bool begins = call == CallId::Begin && !begin_and_end_.inside();
  const bool by_list = begin_and_end_.follow(call, words);
  if (begins || by_list) elements_since_begin_ = {};
  if (begins) {
    begin_position_ = to.words().size();
    begin_generation_ = to.generation();
  } else if (by_list) {
    begin_generation_ = ~std::uint64_t(0);
  }
}

Encoder::Argument Encoder::prepare(CallId call, std::size_t parameter, const std::uint64_t* words) {
  const CallShape& shape = call_shape(call);
  const ParameterShape& pointer = shape.parameters()[parameter];
  const std::uint64_t word = words[parameter];
  Argument argument;
  const auto point = buffer_point(pointer.rule);
  if (!point && word == 0) return argument;
  // Calls that depend on a binding are errors between glBegin and glEnd: OpenGL reads nothing.
  if (point) {
    if (inside_begin()) return argument;
    if (ask(point->binding) != 0) {
      argument.reference = {ReferenceKind::address, word};
      return argument;
    }
    if (word == 0) return argument;
  }
  if (!pointer.input) {
    argument.reference = {ReferenceKind::output, told(word)};
    return argument;
  }
  const auto hold = [&](std::size_t bytes) {
    argument.reference.kind = ReferenceKind::inside;
    argument.bytes = {address_in(word), bytes};
  };
  switch (pointer.rule) {
    case ExtentRule::image: {
      const ImageShape image = image_shape(call, words);
      const PixelStore store = pixel_store(ask(), unpack_names);
      // Formats unknown to OpenGL are errors: nothing is read.
      if (!image_extent(image, store)) return argument;
      argument.owned = tight_image(image, store, address_in(word));
      argument.reference.kind = ReferenceKind::inside;
      argument.bytes = argument.owned;
      return argument;
    }
    case ExtentRule::client_array:
      client_memory_ = true;
      argument.reference = {ReferenceKind::address, told(word)};
      return argument;
    case ExtentRule::texts:
      argument.reference.kind = ReferenceKind::strings;
      return argument;
    case ExtentRule::index_lists:
      argument.reference.kind = ReferenceKind::lists;
      return argument;
    default:
      break;
  }
  if (const auto bytes = pointee_bytes(call, parameter, words)) {
    hold(*bytes);
  } else if (!tells_by_enumerant(pointer.rule)) {
    argument.reference = {ReferenceKind::address, told(word)};
  }
  return argument;
}

void Encoder::write(CallId call, const std::uint64_t* words, std::vector<Argument>& arguments, Records& to) {
  const CallShape& shape = call_shape(call);
  const auto parameters = shape.parameters();
  to.begin(stable_id(call));
  for (std::size_t p = 0; p < parameters.size(); ++p)
    to.append(parameters[p].pointer == 0 ? words[p] : arguments[p].reference.word());
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].pointer == 0) continue;
    Argument& argument = arguments[p];
    const auto count = parameters[p].counted_by == no_argument
                           ? 0
                           : std::max<std::int64_t>(std::int32_t(words[parameters[p].counted_by]), 0);
    const auto* list = reinterpret_cast<const std::uint64_t*>(address_in(words[p]));
    if (argument.reference.kind == ReferenceKind::inside) {
      to.set(p + 1, to.attach(argument.bytes).word());
    } else if (argument.reference.kind == ReferenceKind::strings) {
      const std::uint8_t lengths_at = argument_named(shape, "length");
      const auto* lengths =
          lengths_at == no_argument ? nullptr : reinterpret_cast<const GLint*>(address_in(words[lengths_at]));
      const Reference strings = to.begin_inside(ReferenceKind::strings);
      for (std::int64_t i = 0; i < count; ++i) {
        const std::byte* text = address_in(list[i]);
        std::size_t length = 0;
        if (text != nullptr) {
          length = lengths != nullptr && lengths[i] >= 0 ? std::size_t(lengths[i])
                                                         : std::strlen(reinterpret_cast<const char*>(text));
        }
        to.append(length);
        to.append_bytes({text, length}, true);
      }
      to.end_inside(strings);
      to.set(p + 1, strings.word());
    } else if (argument.reference.kind == ReferenceKind::lists) {
      const auto* counts = reinterpret_cast<const GLsizei*>(address_in(words[argument_named(shape, "count")]));
      const std::size_t size = component_size(GLenum(words[argument_named(shape, "type")]));
      const Reference lists = to.begin_inside(ReferenceKind::lists);
      for (std::int64_t i = 0; i < count; ++i) {
        const std::size_t bytes = list[i] == 0 ? 0 : std::size_t(std::max(counts[i], 0)) * size;
        to.append(bytes);
        to.append_bytes({address_in(list[i]), bytes}, false);
      }
      to.end_inside(lists);
      to.set(p + 1, lists.word());
    }
  }
}

void append_arrays(const std::vector<ClientArray>& arrays, const ElementRange& range, Records& to,
                   bool hides_addresses) {
  to.begin(event::arrays);
  to.append(arrays.size());
  to.reserve(arrays.size() * event::words_per_array);
  std::size_t at = 2;
  std::vector<std::byte> elements;
  for (const ClientArray& array : arrays) {
    const std::int64_t divisor = array.divisor;
    const std::int64_t first = divisor == 0 ? range.first : range.first_instance;
    const std::int64_t last =
        divisor == 0 ? range.last : first + (range.last_instance - range.first_instance) / divisor;
    const std::size_t bytes = array.element_bytes();
    elements.clear();
    // An element before the start of the array, or a null array, is an error of the application; nothing is
    // copied.
    if (bytes != 0 && array.pointer != 0 && last >= first && first >= 0) {
      elements.resize(std::size_t(last - first + 1) * bytes);
      for (std::int64_t i = first; i <= last; ++i) {
        std::memcpy(elements.data() + std::size_t(i - first) * bytes,
                    address_in(array.pointer) + std::size_t(i) * array.step(), bytes);
      }
    }
    const std::array<std::uint64_t, event::words_per_array> fields = {
        std::uint64_t(array.role),
        array.index,
        std::uint64_t(array.size),
        array.type,
        array.normalized,
        std::uint64_t(array.stride),
        Reference{ReferenceKind::address, hides_addresses ? somewhere : array.pointer}.word(),
        array.divisor,
        std::uint64_t(first),
        to.attach(elements).word()};
    for (const std::uint64_t field : fields) to.set(at++, field);
  }
}

bool Encoder::begin_arrays(CallId call, const std::uint64_t* words, Records& to) {
  const std::vector<ClientArray> arrays = client_arrays(ask());
  if (arrays.empty()) return false;
  const auto range = element_range(questions_, call, words);
  if (!range || range->empty()) return false;
  append_arrays(arrays, *range, to, hides_addresses_);
  return true;
}

void Encoder::note_element(CallId call, const std::uint64_t* words) {
  const auto element = element_range(questions_, call, words);
  if (!element) return;
  if (elements_since_begin_.empty()) {
    elements_since_begin_ = *element;
  } else {
    elements_since_begin_.first = std::min(elements_since_begin_.first, element->first);
    elements_since_begin_.last = std::max(elements_since_begin_.last, element->last);
  }
}

void Encoder::insert_arrays_before_begin(Records& to) {
  Records before = Records::without_payload();
  append_arrays(arrays_at_begin_, elements_since_begin_, before, hides_addresses_);
  to.insert(begin_position_, before);
  to.begin(event::arrays_end);
}

void Encoder::encode(CallId call, const std::uint64_t* words, Records& to) {
  const bool draws = client_memory_ && draws_arrays(call);
  if (draws && inside_begin()) note_element(call, words);
  if (client_memory_ && call == CallId::Begin && !inside_begin()) arrays_at_begin_ = client_arrays(ask());
  const bool ended = inside_begin() && call == CallId::End;
  follow_begin_and_end(call, words, to);
  bool between_events = false;
  if (draws && !inside_begin()) between_events = begin_arrays(call, words, to);
  const CallShape& shape = call_shape(call);
  if (shape.plain()) {
    append_plain_call(to, call, words);
  } else {
    arguments_.clear();
    for (std::size_t p = 0; p < shape.parameter_count; ++p)
      arguments_.push_back(shape.parameters()[p].pointer == 0 ? Argument{} : prepare(call, p, words));
    write(call, words, arguments_, to);
  }
  if (between_events) to.begin(event::arrays_end);
  if (ended && !elements_since_begin_.empty() && begin_generation_ == to.generation()) {
    insert_arrays_before_begin(to);
    elements_since_begin_ = {};
  }
}

}  // namespace understudy::spu
