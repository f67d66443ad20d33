// SPDX-License-Identifier: Apache-2.0
// The stage that saves recognised volumes as scenes (`--export`): keeps the request of an image that was shown
// and right, and writes its files when the frame has ended.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "compositor/scene/exported_scene.h"
#include "spu/volume/known_volumes/known_volumes.h"
#include "spu/volume/request/image_request.h"
#include "spu/volume/texture/texels.h"
#include "volume/image.h"

namespace understudy::spu {

class FrameAccount;
class MergedVolumes;
class RenderSession;
class Run;
class ShareGroup;
struct GlContext;

/// An image that may become a scene, and the texture that it shows.
struct SceneCandidate {
  GLuint texture = 0;
  std::uint64_t identity = 0;  ///< of the texture (ShareGroup)
  std::uint64_t texture_version = 0;
  TextureDescription described;
  compositor::ExportedScene scene;
  volume::Image image;  ///< as it was shown; empty: not right, or nothing is visible
};

class SceneExport {
 public:
  SceneExport(const GlContext& context, ShareGroup& group, RenderSession& session, KnownVolumes& volumes,
              FrameAccount& account)
      : context_(context), group_(group), session_(session), volumes_(volumes), account_(account) {}

  /// Returns the image that is to be requested as a candidate; null if scenes are not exported, or this one is
  /// already, or it cannot be, which is logged.
  std::optional<SceneCandidate> candidate(const Run& run, const ImageRequest& image, KnownVolume& volume);

  /// Adds the image, which has passed its comparison if there was one.
  void look_at(SceneCandidate& candidate, const std::optional<Comparison>& comparison,
               const volume::ImageView& shown) const;

  /// Keeps a candidate whose image was shown until write() is called.
  void keep(SceneCandidate candidate);

  bool empty() const { return kept_.empty(); }
  void forget() { kept_.clear(); }
  /// Writes what was kept. The context is current. Throws nothing but cancellation: what fails is logged.
  void write(MergedVolumes& merged);

 private:
  void refuse(KnownVolume& volume, GLuint texture, const std::string& reason);
  /// Why the scene cannot be saved now; empty if it can.
  std::string obstacle(const SceneCandidate& candidate, KnownVolume& volume, MergedVolumes& merged);
  /// What could be read at the end of the frame is not what was drawn. Returns why the volume is not exported:
  /// for `reason` if a later frame is tried, and for `always` if that was in vain too often.
  std::string retry_later(const SceneCandidate& candidate, KnownVolume& volume, const char* reason,
                          const char* always);
  /// Null if there are too many scenes.
  std::optional<int> number();
  void save(const SceneCandidate& candidate, KnownVolume& volume);

  const GlContext& context_;
  ShareGroup& group_;
  RenderSession& session_;
  KnownVolumes& volumes_;
  FrameAccount& account_;
  std::vector<SceneCandidate> kept_;
  std::map<std::uint64_t, int> in_vain_;  ///< frames in a row that had to be tried again, by identity
  std::set<std::string> said_;            ///< reasons that were logged
};

}  // namespace understudy::spu
