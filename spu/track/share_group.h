// SPDX-License-Identifier: Apache-2.0
// What contexts that share objects have in common and cannot be queried from the driver afterwards.
//
// Everything that can be queried is read from the driver: bindings, uniforms, matrices, even texels when a
// volume is recognised. Only what no query returns is tracked: that the contents of a texture changed, what a
// display list contains, and the sources of a program's shaders.
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

/// The buffer of the window that is drawn into after a display list.
enum class ChosenBuffer : std::uint8_t { as_before, front, other };

/// The effect of executing a display list.
struct ListRecord {
  bool draws = false;
  bool only_geometry = true;  ///< only vertices, attributes and draws
  bool only_polygons = true;  ///< no draw is of points, lines or unknown primitives
  bool changes_textures = false;
  // Tracked if a GL server makes the calls (spu/remote/front_buffer.h):
  bool draws_front = false;  ///< into a front buffer that the list itself has chosen
  ChosenBuffer leaves = ChosenBuffer::as_before;
};

/// May be used on any thread: contexts of a group may be current on several threads.
class ShareGroup {
 public:
  /// A number that grows with every change of the texture's contents or definition.
  std::uint64_t texture_version(GLuint texture) const;
  void texture_changed(GLuint texture);
  /// Only texels within `box` of level 0 changed.
  void texture_changed(GLuint texture, const volume::TexelBox& box);
  /// Boxes that enclose all changes after `version`; nothing if the whole texture may have changed.
  std::optional<std::vector<volume::TexelBox>> changes_since(GLuint texture, std::uint64_t version) const;
  /// A texture changed whose name is unknown. Ignored while there are no volumes, because nobody needs the
  /// version then.
  void some_texture_changed();
  /// The name may be reused for another texture.
  void texture_deleted(GLuint texture);
  /// A number that grows when a texture with a record here is deleted: whatever units have recorded by texture
  /// name is invalid then.
  std::uint64_t deletions() const { return deletions_.load(std::memory_order_relaxed); }

  /// Returns a number that the texture keeps until it is deleted, and that no other texture has had: names are
  /// reused.
  std::uint64_t identity(GLuint texture);
  /// Whether the texture of this name still is the one that had this identity.
  bool is(GLuint texture, std::uint64_t identity) const;

  /// A 3-D texture has contents, so draws must be watched.
  void volume_defined() { has_volumes_.store(true, std::memory_order_relaxed); }
  /// A context starts or stops watching for stacks of 2-D textures.
  void stacks_watched() { stack_watchers_.fetch_add(1, std::memory_order_relaxed); }
  void stacks_left() { stack_watchers_.fetch_sub(1, std::memory_order_relaxed); }
  bool has_volumes() const {
    return has_volumes_.load(std::memory_order_relaxed) || stack_watchers_.load(std::memory_order_relaxed) > 0;
  }

  /// The texture is or was attached to a framebuffer or bound as an image, so its contents may change without
  /// an upload.
  void texture_rendered_to(GLuint texture);
  bool is_rendered_to(GLuint texture) const;

  /// Single draw buffers or viewports of a context may have a state of their own. A display list that one
  /// context compiles may set such a state in another.
  void indexed_state_set() { indexed_state_.store(true, std::memory_order_relaxed); }
  bool has_indexed_state() const { return indexed_state_.load(std::memory_order_relaxed); }

  /// The calls of one of the contexts are not tracked from now on, so no information about the group's objects
  /// is reliable.
  void leave_to_driver() { left_to_driver_.store(true, std::memory_order_relaxed); }
  bool is_left_to_driver() const { return left_to_driver_.load(std::memory_order_relaxed); }

  ProgramSources& programs() { return programs_; }
  const ProgramSources& programs() const { return programs_; }

  void list_defined(GLuint list, const ListRecord& record);
  void lists_deleted(GLuint first, GLsizei count);
  std::optional<ListRecord> list(GLuint list) const;
  /// False until a list was defined that changes textures.
  bool lists_change_textures() const { return lists_change_textures_.load(std::memory_order_relaxed); }

 private:
  struct TextureRecord {
    struct Change {
      std::uint64_t version;
      volume::TexelBox box;
    };
    std::uint64_t version = 0;
    std::uint64_t changed_wholly = 0;  ///< version of the last change of the whole texture
    std::vector<Change> changes;       ///< after that, oldest first
    bool rendered_to = false;
    std::uint64_t identity = 0;
  };

  /// Requires the mutex.
  TextureRecord& known(GLuint texture);

  ProgramSources programs_;
  mutable std::mutex mutex_;
  std::map<GLuint, TextureRecord> textures_;
  std::map<GLuint, ListRecord> lists_;
  std::atomic<std::uint64_t> changes_{0};       ///< source of all versions, each used only once
  std::atomic<std::uint64_t> some_changed_{0};  ///< version of the last change of an unknown texture
  std::atomic<std::uint64_t> deletions_{0};
  std::atomic<bool> textures_are_known_{false};  ///< textures_ is not empty
  std::atomic<bool> has_volumes_{false};
  std::atomic<int> stack_watchers_{0};
  std::atomic<bool> lists_change_textures_{false};
  std::atomic<bool> indexed_state_{false};
  std::atomic<bool> left_to_driver_{false};
};

}  // namespace understudy::spu
