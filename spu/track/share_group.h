// SPDX-License-Identifier: Apache-2.0
// What contexts that share objects have in common, and the driver cannot tell afterwards.
//
// The driver is the truth for everything it can be asked: bindings, uniforms, matrices, even texels are read
// from it when a volume is recognised. Tracked is only what no query answers: that the contents of a texture
// changed, what a display list holds, and the sources of a program's shaders.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "dispatch/table.h"
#include "spu/track/program_sources.h"
#include "volume/texel_box.h"

namespace understudy::spu {

/// Where a display list leaves what follows to be drawn in the window.
enum class ChosenBuffer : std::uint8_t { as_before, front, other };

/// What executing a display list would do.
struct ListRecord {
  bool draws = false;
  bool only_geometry = true;  ///< nothing but vertices, attributes and draws
  bool only_polygons = true;  ///< no draw is of points or lines, or of what nobody knows
  bool changes_textures = false;
  // Followed where a GL server makes the calls (spu/remote/front_buffer.h):
  bool draws_front = false;  ///< into a front buffer that it has chosen itself
  ChosenBuffer leaves = ChosenBuffer::as_before;
};

/// Safe from any thread: contexts of one group may be current on several.
class ShareGroup {
 public:
  /// Grows with every change of the texture's contents or definition.
  std::uint64_t texture_version(GLuint texture) const;
  void texture_changed(GLuint texture);
  /// Nothing outside `box` of its level 0 did.
  void texture_changed(GLuint texture, const volume::TexelBox& box);
  /// Boxes around what changed after `version`; nothing where that may be anything.
  std::optional<std::vector<volume::TexelBox>> changes_since(GLuint texture, std::uint64_t version) const;
  /// A change of a texture whose name is not known. Before there are volumes nobody asks for it, and it is not
  /// noted.
  void some_texture_changed();
  /// The name may come again, for another texture.
  void texture_deleted(GLuint texture);
  /// Grows when a texture is deleted of which something is known here: what is noted elsewhere by name is void
  /// then.
  std::uint64_t deletions() const { return deletions_.load(std::memory_order_relaxed); }

  /// From now on until the texture is deleted, remembers() is true for it.
  void remember(GLuint texture);
  bool remembers(GLuint texture) const;

  /// A 3-D texture has contents: what draws are watched for.
  void volume_defined() { has_volumes_.store(true, std::memory_order_relaxed); }
  /// A context watches for stacks of 2-D textures, or does so no longer.
  void stacks_watched() { stack_watchers_.fetch_add(1, std::memory_order_relaxed); }
  void stacks_left() { stack_watchers_.fetch_sub(1, std::memory_order_relaxed); }
  bool has_volumes() const {
    return has_volumes_.load(std::memory_order_relaxed) || stack_watchers_.load(std::memory_order_relaxed) > 0;
  }

  /// The texture is, or was, attached to a framebuffer or bound as an image: its contents change without an
  /// upload.
  void texture_rendered_to(GLuint texture);
  bool is_rendered_to(GLuint texture) const;

  /// What one of its contexts does from now on is not followed, so nothing known of the group's objects can be
  /// relied on.
  void leave_to_driver() { left_to_driver_.store(true, std::memory_order_relaxed); }
  bool is_left_to_driver() const { return left_to_driver_.load(std::memory_order_relaxed); }

  ProgramSources& programs() { return programs_; }
  const ProgramSources& programs() const { return programs_; }

  void list_defined(GLuint list, const ListRecord& record);
  void lists_deleted(GLuint first, GLsizei count);
  std::optional<ListRecord> list(GLuint list) const;
  /// False until a list was defined that changes textures when it is called.
  bool lists_change_textures() const { return lists_change_textures_.load(std::memory_order_relaxed); }

 private:
  struct TextureRecord {
    struct Change {
      std::uint64_t version;
      volume::TexelBox box;
    };
    std::uint64_t version = 0;
    std::uint64_t changed_wholly = 0;  ///< version
    std::vector<Change> changes;       ///< since then, the oldest first
    bool rendered_to = false;
  };

  /// With the mutex held.
  TextureRecord& known(GLuint texture);

  ProgramSources programs_;
  mutable std::mutex mutex_;
  std::map<GLuint, TextureRecord> textures_;
  std::map<GLuint, ListRecord> lists_;
  std::atomic<std::uint64_t> changes_{0};       ///< source of all versions: none is ever given twice
  std::atomic<std::uint64_t> some_changed_{0};  ///< version of the last change whose texture is not known
  std::atomic<std::uint64_t> deletions_{0};
  std::atomic<bool> textures_are_known_{false};  ///< textures_ is not empty
  std::atomic<bool> has_volumes_{false};
  std::atomic<int> stack_watchers_{0};
  std::atomic<bool> lists_change_textures_{false};
  std::atomic<bool> left_to_driver_{false};
};

}  // namespace understudy::spu
