// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/current_attributes.h"

#include <string_view>

#include "spu/track/calls.h"
#include "spu/volume/observation/client_arrays.h"

namespace understudy::spu {
namespace {

constexpr std::uint32_t every_generic_attribute = 0xffff;  // the 16 that OpenGL guarantees

/// What a call of kind `vertex` sets. A vertex itself sets no current attribute.
enum class AttributeKind : std::uint8_t {
  vertex,
  fixed_function,
  float_generic,
  integer_generic,
  double_generic
};

AttributeKind find_kind(std::string_view name) {
  constexpr std::string_view generic = "glVertexAttrib";
  if (!name.starts_with(generic))
    return name.starts_with("glVertex") ? AttributeKind::vertex : AttributeKind::fixed_function;
  name.remove_prefix(generic.size());
  return name.starts_with('I')   ? AttributeKind::integer_generic
         : name.starts_with('L') ? AttributeKind::double_generic
                                 : AttributeKind::float_generic;
}

AttributeKind kind_of_attribute(CallId call) {
  static const std::array<AttributeKind, call_count> kinds = [] {
    std::array<AttributeKind, call_count> all{};
    for (std::size_t i = 0; i < call_count; ++i) all[i] = find_kind(call_name(CallId(i)));
    return all;
  }();
  return kinds[std::size_t(call)];
}

std::uint32_t bit_of(std::uint64_t index) {
  return index < 32 ? std::uint32_t(1) << index : 0;
}

template <class Take>
void for_each(std::uint32_t attributes, const Take& take) {
  for (GLuint index = 0; attributes >> index != 0; ++index) {
    if ((attributes >> index & 1) != 0) take(index);
  }
}

}  // namespace

void AttributeSet::add(CallId call, const std::uint64_t* words) {
  switch (kind_of_attribute(call)) {
    case AttributeKind::vertex:
      break;
    case AttributeKind::fixed_function:
      fixed_function = true;
      break;
    case AttributeKind::float_generic:
      floats |= bit_of(words[0]) & generic;
      break;
    case AttributeKind::integer_generic:
      integers |= bit_of(words[0]) & generic;
      break;
    case AttributeKind::double_generic:
      doubles |= bit_of(words[0]) & generic;
      break;
  }
}

void AttributeSet::add(std::span<const MemoryArray> arrays) {
  for (const MemoryArray& array : arrays) {
    if (array.role == MemoryArray::Role::generic) {
      floats |= bit_of(std::uint64_t(array.index)) & generic;
    } else if (array.role != MemoryArray::Role::vertex) {
      fixed_function = true;
    }
  }
}

void AttributeSet::add_list() {
  fixed_function = true;
  floats |= every_generic_attribute & generic;
}

void AttributeSet::add(const AttributeSet& others) {
  fixed_function |= others.fixed_function;
  floats |= others.floats;
  integers |= others.integers;
  doubles |= others.doubles;
}

CurrentAttributes::CurrentAttributes(const DispatchTable& gl, const AttributeSet& set) {
  if (set.fixed_function) {
    FixedFunction& now = fixed_function_.emplace();
    gl.GetFloatv(GL_CURRENT_COLOR, now.colour.data());
    gl.GetFloatv(GL_CURRENT_SECONDARY_COLOR, now.secondary_colour.data());
    gl.GetFloatv(GL_CURRENT_NORMAL, now.normal.data());
    gl.GetFloatv(GL_CURRENT_FOG_COORD, &now.fog_coordinate);
    gl.GetBooleanv(GL_EDGE_FLAG, &now.edge_flag);
    GLint active = GL_TEXTURE0;
    gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
    for (std::size_t unit = 0; unit < now.coordinates.size(); ++unit) {
      gl.ActiveTexture(GLenum(GL_TEXTURE0 + unit));
      gl.GetFloatv(GL_CURRENT_TEXTURE_COORDS, now.coordinates[unit].data());
    }
    gl.ActiveTexture(GLenum(active));
  }
  for_each(set.floats, [&](GLuint index) {
    floats_.push_back({.index = index});
    gl.GetVertexAttribfv(index, GL_CURRENT_VERTEX_ATTRIB, floats_.back().value.data());
  });
  for_each(set.integers, [&](GLuint index) {
    integers_.push_back({.index = index});
    gl.GetVertexAttribIiv(index, GL_CURRENT_VERTEX_ATTRIB, integers_.back().value.data());
  });
  for_each(set.doubles, [&](GLuint index) {
    doubles_.push_back({.index = index});
    gl.GetVertexAttribLdv(index, GL_CURRENT_VERTEX_ATTRIB, doubles_.back().value.data());
  });
}

void CurrentAttributes::make_current(const DispatchTable& gl) const {
  if (fixed_function_) {
    gl.Color4fv(fixed_function_->colour.data());
    gl.SecondaryColor3fv(fixed_function_->secondary_colour.data());
    gl.Normal3fv(fixed_function_->normal.data());
    gl.FogCoordf(fixed_function_->fog_coordinate);
    gl.EdgeFlag(fixed_function_->edge_flag);
    for (std::size_t unit = 0; unit < fixed_function_->coordinates.size(); ++unit)
      gl.MultiTexCoord4fv(GLenum(GL_TEXTURE0 + unit), fixed_function_->coordinates[unit].data());
  }
  for (const auto& attribute : floats_) gl.VertexAttrib4fv(attribute.index, attribute.value.data());
  for (const auto& attribute : integers_) gl.VertexAttribI4iv(attribute.index, attribute.value.data());
  for (const auto& attribute : doubles_) gl.VertexAttribL4dv(attribute.index, attribute.value.data());
}

}  // namespace understudy::spu
