// SPDX-License-Identifier: Apache-2.0
// The track unit: records what cannot be queried from the driver later (see share_group.h), and starts watching
// for volumes when the first 3-D texture is defined. It makes no queries: with this unit alone, an
// application's calls reach the driver unchanged. If the driver is remote, it can answer queries itself
// (answers.h).
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

  /// With `answer`, queries are answered without the driver if the answer is known.
  explicit Track(Chain& chain, bool answer = false)
      : chain_(chain), answers_(answer ? std::make_unique<Answers>() : nullptr) {}

  /// The track unit of the chain that is current on this thread, which must have one.
  static Track& current() { return *Chain::current()->find<Track>(); }

  const char* tag_address() const override { return &tag; }
  void fill(Phase phase, DispatchTable& table) override;
  void made_current() override;
  void frame_ended(FrameEnd kind) override;
  void give_up() override { chain_.group().leave_to_driver(); }

  /// The effect so far of the list that is being compiled.
  ListRecord& open_list() { return open_list_; }
  void begin_list(GLuint list, GLenum mode);
  void end_list();

  /// Called in the plain phase before a texture changes. Without volumes it does not matter which one; if
  /// another context of the group has a volume, the watching phase begins first, so that the units below see
  /// the call.
  void texture_changes();
  /// A 3-D texture is being defined: draws are watched from now on.
  void volume_defined();
  void texture_rendered_to(GLuint texture);

  /// Queries the driver for the context's state. The context must be current and not between glBegin and glEnd.
  State state() const;

  /// Null if the driver answers all queries.
  Answers* answers() { return answers_.get(); }

  Chain& chain() { return chain_; }
  const DispatchTable& below() const { return chain_.below(*this); }

 private:
  void fill_own(Phase phase, DispatchTable& table);

  Chain& chain_;
  std::unique_ptr<Answers> answers_;
  GLuint list_ = 0;
  bool list_is_executed_ = false;  ///< commands in the open list are also executed
  Phase phase_before_list_ = Phase::plain;
  ListRecord open_list_;
  /// Textures already reported to the group, at their name modulo the size: attaching one again, as many
  /// viewers do in every frame, takes no lock.
  std::array<GLuint, 64> rendered_to_{};
  std::uint64_t deletions_ = 0;  ///< of the group, when rendered_to_ was last valid
};

}  // namespace understudy::spu
