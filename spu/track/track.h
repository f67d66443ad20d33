// SPDX-License-Identifier: Apache-2.0
// The track unit: keeps what the driver cannot be asked for later (see share_group.h) and starts the watch for
// volumes when the first 3-D texture appears. It asks the driver nothing: under it alone, an application's
// calls reach the driver as they are. Where the driver is far away it can answer queries itself (answers.h).
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "spu/chain.h"
#include "spu/track/answers.h"
#include "spu/track/share_group.h"

namespace understudy::spu {

class State;

class Track final : public Unit {
 public:
  static constexpr char tag = 't';

  /// With `answer`, queries are answered without the driver where the answer is known.
  explicit Track(Chain& chain, bool answer = false)
      : chain_(chain), answers_(answer ? std::make_unique<Answers>() : nullptr) {}

  /// That of the chain that is current on this thread, which has one.
  static Track& current() { return *Chain::current()->find<Track>(); }

  const char* tag_address() const override { return &tag; }
  void fill(Phase phase, DispatchTable& table) override;
  void made_current() override;
  void frame_ended(FrameEnd kind) override;
  void give_up() override { chain_.group().leave_to_driver(); }

  /// What the list being compiled holds so far.
  ListRecord& open_list() { return open_list_; }
  void begin_list(GLuint list, GLenum mode);
  void end_list();

  /// A texture is about to change in the plain phase. Which one does not matter while there are no volumes;
  /// once another context of the group has one, those below who want to know it are to see the call.
  void texture_changes();
  /// A 3-D texture is being defined: from now on draws are watched.
  void volume_defined();
  void texture_rendered_to(GLuint texture);

  /// What state the context is in; the driver is asked when this is. The context is current, and not between
  /// glBegin and glEnd.
  State state() const;

  /// Null where the driver answers every query.
  Answers* answers() { return answers_.get(); }

  Chain& chain() { return chain_; }
  const DispatchTable& below() const { return chain_.below(*this); }

 private:
  void fill_own(Phase phase, DispatchTable& table);

  Chain& chain_;
  std::unique_ptr<Answers> answers_;
  GLuint list_ = 0;
  bool list_is_executed_ = false;  ///< the commands of the open list are executed while they are compiled
  Phase phase_before_list_ = Phase::plain;
  ListRecord open_list_;
  /// Textures that the group was told of already, at their name modulo the size: attaching one again, as many
  /// viewers do in every frame, takes no lock.
  std::array<GLuint, 64> rendered_to_{};
  std::uint64_t deletions_ = 0;  ///< of the group, when rendered_to_ was last right
};

}  // namespace understudy::spu
