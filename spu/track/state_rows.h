// SPDX-License-Identifier: Apache-2.0
// The state of an OpenGL context as a table: the items of state, the query for each, and the call that sets it.
#pragma once

#include <array>
#include <span>

#include "dispatch/call_id.h"

namespace understudy::spu {

/// How the values are queried.
enum class Question : std::uint8_t {
  value,             ///< glGetDoublev: exact for integers and floats
  enabled,           ///< glIsEnabled
  enabled_indexed,   ///< glIsEnabledi
  integer_indexed,   ///< glGetIntegeri_v
  address_indexed,   ///< glGetInteger64i_v
  float_indexed,     ///< glGetFloati_v
  double_indexed,    ///< glGetDoublei_v
  light,             ///< glGetLightfv
  material,          ///< glGetMaterialfv
  texture_env,       ///< glGetTexEnvfv
  texture_gen,       ///< glGetTexGendv
  clip_plane,        ///< glGetClipPlane
  vertex_attribute,  ///< glGetVertexAttribdv
};

/// What a row has one item for.
enum class Per : std::uint8_t {
  context,
  light,
  clip_plane,
  texture_coordinates,
  texture_unit,
  draw_buffer,
  viewport,
  vertex_attribute,
  sample_mask,
  uniform_buffer,
  storage_buffer,
  counter_buffer,
};

/// What must be selected before the row is queried or set.
enum class Selector : std::uint8_t {
  none,
  texture_unit,         ///< GL_ACTIVE_TEXTURE
  client_texture_unit,  ///< GL_CLIENT_ACTIVE_TEXTURE
};

/// Rows are set in the order of their groups, so that whatever a later group's calls depend on is set.
enum class StateGroup : std::uint8_t {
  framebuffer,  ///< which object is bound; its own state follows
  of_framebuffer,
  vertex_array,
  of_vertex_array,
  indexed_buffers,  ///< glBindBufferRange also binds to the target itself
  bindings,
  eye_space,  ///< transformed by the modelview matrix when set
  matrices,
  values,
  current,       ///< with GL_COLOR_MATERIAL, the current colour is also the material's
  capabilities,  ///< after the state that they enable
  selectors,
};

struct StateQuery {
  GLenum name = 0;
  int count = 0;
};

/// glSet(target, number, name, values...), of which the first three are present only if specified.
struct StateRow {
  StateGroup group{};
  CallId set{};
  std::array<StateQuery, 8> queries{};  ///< entries without a count are unused
  Question question = Question::value;
  Per per = Per::context;
  Selector selector = Selector::none;
  GLenum matrix_mode = 0;  ///< required by the call; 0: none
  GLenum target = 0;       ///< first argument; 0: none
  bool numbered = false;   ///< next argument: first_number + index of the item
  GLenum first_number = 0;
  bool named = false;          ///< next argument: the name of the first query
  int from_value = 0;          ///< index of the first of the query's values that belongs to this row
  bool compatibility = false;  ///< not in core profiles
  bool core = false;           ///< only in core profiles
  int from_version = 0;        ///< 100 * major + 10 * minor
  int below_version = 1000;

  /// Number of values of an item.
  constexpr int count() const {
    int sum = 0;
    for (const StateQuery& query : queries) sum += query.count;
    return sum;
  }
};

/// Maximum number of values of an item.
constexpr int max_state_values = 16;

/// All rows, in the order of their groups.
std::span<const StateRow> state_rows();

}  // namespace understudy::spu
