// SPDX-License-Identifier: Apache-2.0
// The part of a trace before the cut. It is played, and every record gets an action: definitions are kept,
// drawing is dropped, and drawn contents that later frames may use are restored (restoration.h).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "dispatch/call_shape.h"
#include "spu/player/player.h"
#include "spu/stream/record.h"
#include "spu/track/call_role.h"

namespace understudy::spu {

enum class RecordAction : std::uint8_t {
  keep,
  drop,
  keep_without_data,  ///< an upload whose data is replaced later: it still allocates the storage
  expand,             ///< a display list: its changes of state are kept, its drawing is not
};

/// An object, shared by contexts, that OpenGL itself has written to; `here` is its local name.
struct DrawnObject {
  std::uint64_t group = 0;  ///< of contexts
  ObjectKind kind = ObjectKind::none;
  GLuint here = 0;

  bool operator<(const DrawnObject& other) const {
    return std::tie(group, kind, here) < std::tie(other.group, other.kind, other.here);
  }
};

/// What the stream specifies about such an object.
struct StreamObject {
  GLuint name = 0;
  GLenum target = GL_NONE;  ///< of textures
};

class Prefix {
 public:
  explicit Prefix(Player& player) : player_(player) {}

  /// Plays the record and determines its action. Returns an error in the record, or an empty string.
  std::string play(const Record& record);

  /// By number of the record; final when the whole prefix has been played.
  const std::vector<RecordAction>& actions() const { return actions_; }
  const std::map<DrawnObject, StreamObject>& drawn() const { return drawn_; }
  /// The thread of the last record.
  std::uint64_t thread() const { return thread_; }

 private:
  using Box = std::array<std::int64_t, 6>;  ///< first x, y, z, then the ends, exclusive

  struct Upload {
    std::size_t record = 0;
    Box box{};
    bool makes_room = false;
  };
  /// group, kind of object, its local name, target, level
  using Image = std::tuple<std::uint64_t, ObjectKind, GLuint, GLenum, GLint>;

  struct ThreadState {
    bool inside_begin = false;
    bool compiling = false;
    RecordAction last_call = RecordAction::keep;
    /// The last record that set each current attribute since glBegin.
    std::map<std::pair<std::uint32_t, std::uint64_t>, std::size_t> attributes;
  };

  RecordAction action_of_event(const Record& record, const ThreadState& thread) const;
  RecordAction action_of_call(CallId call, const Record& record, ThreadState& thread);
  void look_before(CallId call, const Record& record, const ThreadState& thread);
  void look_at_texture(CallId call, const Record& record);
  void look_at_buffer(CallId call, const Record& record);
  void note_upload(CallId call, const Record& record);
  void note_answers(const Record& record);
  void supersede(const Image& image, const Upload& upload);
  GLuint ask(GLenum name) const;
  void mark(ObjectKind kind, GLuint here);
  void mark_attachments();
  void mark_bound_texture(GLenum target);
  StreamObject& stream_object(ObjectKind kind, GLuint here);

  Player& player_;
  std::vector<RecordAction> actions_;
  std::map<std::uint64_t, ThreadState> threads_;
  std::uint64_t thread_ = 0;
  std::map<Image, std::vector<Upload>> uploads_;
  std::map<DrawnObject, StreamObject> drawn_;
  std::map<DrawnObject, StreamObject> objects_;
  GLenum last_created_ = GL_NONE;  ///< target of textures whose names are not yet known
  /// The framebuffer whose attachments were queried last; they are queried again only if they may have changed.
  std::tuple<std::uint64_t, GLuint> framebuffer_seen_{};
};

/// The name of the binding of a texture target, for glGetIntegerv; 0 if there is none.
GLenum texture_binding(GLenum target);

}  // namespace understudy::spu
