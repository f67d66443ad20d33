// The track unit: keeps what the driver cannot be asked for later (see share_group.h) and starts the watch for
// volumes when the first 3-D texture appears.
#pragma once

#include "spu/chain.h"
#include "spu/track/share_group.h"

namespace understudy::spu {

class Track final : public Unit {
 public:
  static constexpr char tag = 't';

  explicit Track(Chain& chain) : chain_(chain) {}

  const char* tag_address() const override { return &tag; }
  void fill(Phase phase, DispatchTable& table) override;
  void frame_ended(FrameEnd kind) override;

  /// What the list being compiled holds so far.
  ListRecord& open_list() { return open_list_; }
  void begin_list(GLuint list);
  void end_list();

  /// The textures of `dimensions` dimensions bound to the active unit are about to change.
  void bound_textures_change(int dimensions);

  Chain& chain() { return chain_; }
  const DispatchTable& below() const { return chain_.below(*this); }

 private:
  Chain& chain_;
  GLuint list_ = 0;
  Phase phase_before_list_ = Phase::plain;
  ListRecord open_list_;
};

}  // namespace understudy::spu
