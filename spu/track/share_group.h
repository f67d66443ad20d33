// What contexts that share objects have in common, and the driver cannot tell afterwards.
//
// The driver is the truth for everything it can be asked: bindings, uniforms, matrices, even texels are read
// from it when a volume is recognised. Tracked is only what no query answers: that the contents of a texture
// changed, what a display list holds, and the sources of a program's shaders (lost once they are detached and
// deleted).
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {

struct SamplerUniform {
  std::string name;
  GLenum type = 0;
  GLint location = -1;
};

/// A program as it was when it was last linked.
struct ProgramRecord {
  std::uint64_t link = 0;  ///< different for every link of every program
  std::vector<std::string> vertex_sources;
  std::vector<std::string> fragment_sources;
  bool vertex_shader = false;
  bool other_stages = false;
  bool fragment_source_known = false;
  std::vector<SamplerUniform> samplers;
};

/// What executing a display list would do.
struct ListRecord {
  bool draws = false;
  bool only_geometry = true;  ///< nothing but vertices, attributes and draws
  bool changes_textures = false;
};

/// Safe from any thread: contexts of one group may be current on several.
class ShareGroup {
 public:
  /// Grows with every change of the texture's contents or definition.
  std::uint64_t texture_version(GLuint texture) const;
  void texture_changed(GLuint texture);
  /// A change whose target is not known, such as an upload inside a display list.
  void all_textures_changed() { epoch_.fetch_add(1, std::memory_order_relaxed); }
  void texture_deleted(GLuint texture);

  /// A 3-D texture with contents; what draws are watched for.
  void volume_defined(GLuint texture);
  bool is_volume(GLuint texture) const;
  bool has_volumes() const { return has_volumes_.load(std::memory_order_relaxed); }

  /// The texture is, or was, attached to a framebuffer or bound as an image: its contents change without an
  /// upload.
  void texture_rendered_to(GLuint texture);
  bool is_rendered_to(GLuint texture) const;

  void program_linked(GLuint program, ProgramRecord record);
  void program_deleted(GLuint program);
  /// Stays valid until the program is linked again or deleted; null when it was never linked in our sight.
  const ProgramRecord* program(GLuint program) const;

  void list_defined(GLuint list, const ListRecord& record);
  void lists_deleted(GLuint first, GLsizei count);
  std::optional<ListRecord> list(GLuint list) const;

 private:
  struct TextureRecord {
    std::uint64_t version = 0;
    bool volume = false;
    bool rendered_to = false;
  };

  mutable std::mutex mutex_;
  std::map<GLuint, TextureRecord> textures_;
  std::map<GLuint, std::unique_ptr<ProgramRecord>> programs_;
  std::map<GLuint, ListRecord> lists_;
  std::atomic<std::uint64_t> epoch_{0};
  std::atomic<bool> has_volumes_{false};
  std::uint64_t changes_ = 0;  ///< source of versions, so that a reused texture name never repeats one
  std::uint64_t links_ = 0;
};

}  // namespace understudy::spu
