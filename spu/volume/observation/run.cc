// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/run.h"

#include <algorithm>
#include <array>
#include <optional>

#include "spu/stream/plain_calls.h"

namespace understudy::spu {
namespace {

/// The current colour, normal, texture coordinates and generic attributes, as they were.
class CurrentAttributes {
 public:
  explicit CurrentAttributes(const DispatchTable& gl) : gl_(gl) {
    gl_.GetFloatv(GL_CURRENT_COLOR, colour_.data());
    gl_.GetFloatv(GL_CURRENT_NORMAL, normal_.data());
    GLint active = GL_TEXTURE0;
    gl_.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
    for (std::size_t unit = 0; unit < coordinates_.size(); ++unit) {
      gl_.ActiveTexture(GLenum(GL_TEXTURE0 + unit));
      gl_.GetFloatv(GL_CURRENT_TEXTURE_COORDS, coordinates_[unit].data());
    }
    gl_.ActiveTexture(GLenum(active));
    for (std::size_t i = 0; i < generic_.size(); ++i) {
      gl_.GetVertexAttribfv(GLuint(i + 1), GL_CURRENT_VERTEX_ATTRIB, generic_[i].data());
    }
  }
  ~CurrentAttributes() {
    gl_.Color4fv(colour_.data());
    gl_.Normal3fv(normal_.data());
    for (std::size_t unit = 0; unit < coordinates_.size(); ++unit) {
      gl_.MultiTexCoord4fv(GLenum(GL_TEXTURE0 + unit), coordinates_[unit].data());
    }
    for (std::size_t i = 0; i < generic_.size(); ++i) gl_.VertexAttrib4fv(GLuint(i + 1), generic_[i].data());
  }
  CurrentAttributes(const CurrentAttributes&) = delete;
  CurrentAttributes& operator=(const CurrentAttributes&) = delete;

 private:
  using Four = std::array<GLfloat, 4>;
  const DispatchTable& gl_;
  Four colour_{};
  Four normal_{};
  std::array<Four, 8> coordinates_{};  ///< OpenGL's least number of fixed-function units that carry coordinates
  std::array<Four, 15> generic_{};     ///< attribute 0 is the vertex
};

}  // namespace

void Run::bind_slice(GLuint texture) {
  append_call(calls_, &DispatchTable::BindTexture, GL_TEXTURE_2D, texture);
  // For feedback mode; core profiles have none, and no fixed-function vertices either.
  if (!pipeline_.vertex_shader) append_call(calls_, &DispatchTable::PassThrough, GLfloat(slices_.size()));
  slices_.push_back({texture, draws});
}

void Run::draw_arrays(GLenum mode, std::span<const GLint> first, std::span<const GLsizei> count) {
  buffer_draws_.push_back({calls_.words().size(), mode, 0, counts_.size(), count.size()});
  counts_.insert(counts_.end(), count.begin(), count.end());
  first_.insert(first_.end(), first.begin(), first.end());
  base_vertex_.resize(counts_.size());
  offsets_.resize(counts_.size());
  reads_arrays = true;
}

void Run::draw_elements(GLenum mode, std::span<const ElementPart> ranges, GLenum type) {
  buffer_draws_.push_back({calls_.words().size(), mode, type, counts_.size(), ranges.size()});
  for (const ElementPart& range : ranges) {
    counts_.push_back(range.count);
    offsets_.push_back(range.offset);
    base_vertex_.push_back(range.base_vertex);
  }
  first_.resize(counts_.size());
  reads_arrays = true;
}

void Run::draw_kept(const DispatchTable& gl, const BufferDraw& draw) const {
  const GLsizei* const count = counts_.data() + draw.part;
  const void* const* const offset = offsets_.data() + draw.part;
  const GLint* const base = base_vertex_.data() + draw.part;
  // Contexts that know no base vertices are never asked for one.
  const bool based = std::any_of(base, base + draw.parts, [](GLint vertex) { return vertex != 0; });
  const auto parts = GLsizei(draw.parts);
  if (draw.type == 0) {
    gl.MultiDrawArrays(draw.mode, first_.data() + draw.part, count, parts);
  } else if (parts == 1 && based) {
    gl.DrawElementsBaseVertex(draw.mode, *count, draw.type, *offset, *base);
  } else if (parts == 1) {
    gl.DrawElements(draw.mode, *count, draw.type, *offset);
  } else if (based) {
    gl.MultiDrawElementsBaseVertex(draw.mode, count, draw.type, offset, parts, base);
  } else {
    gl.MultiDrawElements(draw.mode, count, draw.type, offset, parts);
  }
}

std::vector<GLuint> Run::slices() const {
  std::vector<GLuint> textures;
  for (const StackSlice& slice : slices_) {
    if (slice.draws_before < draws) textures.push_back(slice.texture);
  }
  return textures;
}

std::size_t Run::slices_drawn_alike() const {
  const std::size_t drawn = slices().size();
  if (drawn == 0 || draws % drawn != 0) return 0;
  const std::size_t of_slice = draws / drawn;
  for (std::size_t i = 0; i < drawn; ++i) {
    if (slices_[i].draws_before != i * of_slice) return 0;
  }
  return drawn;
}

GLuint Run::volume_texture() const {
  if (!pipeline_.stack) return pipeline_.volume.texture;
  const std::vector<GLuint> textures = slices();
  return textures.empty() ? pipeline_.volume.texture : std::min(textures.front(), textures.back());
}

void Run::replay(const DispatchTable& gl) const {
  std::optional<CurrentAttributes> current;
  if (expanded_arrays) current.emplace(gl);
  const auto words = calls_.words();
  std::size_t done = 0;
  for (const BufferDraw& draw : buffer_draws_) {
    make_plain_calls(words.subspan(done, draw.position - done), gl);
    done = draw.position;
    draw_kept(gl, draw);
  }
  make_plain_calls(words.subspan(done), gl);
}

}  // namespace understudy::spu
