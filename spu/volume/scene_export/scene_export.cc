// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/scene_export/scene_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "compositor/logging/log.h"
#include "compositor/service/limits.h"
#include "spu/report/counters.h"
#include "spu/report/volume_report.h"
#include "spu/track/share_group.h"
#include "spu/volume/context/context.h"
#include "spu/volume/context/saved_state.h"
#include "spu/volume/merging/merged_volumes.h"
#include "spu/volume/observation/run.h"
#include "spu/volume/proxy/ray_caster_stage.h"
#include "spu/volume/scene_export/scene_files.h"
#include "spu/volume/session/render_session.h"
#include "spu/volume/timing/frame_account.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::spu {
namespace {

/// A volume whose texels change after it is drawn in every frame is given up: each try compares a whole image.
constexpr int max_in_vain = 4;

/// Filters like level 0 alone: the texture's own filter, which the application's sampler may have replaced,
/// does not change its texels, and must not make describe_texture() refuse it.
class PlainSampler {
 public:
  /// Binds it to `unit`, if there are samplers.
  PlainSampler(const GlContext& context, GLuint unit) : gl_(*context.gl) {
    constexpr int with_samplers = 330;
    if (context.version < with_samplers) return;
    gl_.GenSamplers(1, &name_);
    gl_.SamplerParameteri(name_, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl_.SamplerParameteri(name_, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl_.BindSampler(unit, name_);
  }
  PlainSampler(const PlainSampler&) = delete;
  PlainSampler& operator=(const PlainSampler&) = delete;
  /// Whatever unit it is bound to has none then.
  ~PlainSampler() {
    if (name_ != 0) gl_.DeleteSamplers(1, &name_);
  }

 private:
  const DispatchTable& gl_;
  GLuint name_ = 0;
};

/// Whether texels of both are read, and mean, the same. How they are sampled is not compared.
bool has_same_texels(const TextureDescription& a, const TextureDescription& b) {
  return a.size == b.size && a.type == b.type && a.held == b.held && a.steps == b.steps && a.base == b.base &&
         a.opaque == b.opaque && a.grey == b.grey && a.format_name == b.format_name;
}

/// Whether the texels of a candidate can be read now as they were when it was drawn.
bool is_readable(const GlContext& context, const SceneCandidate& candidate) {
  SavedState saved(context);
  saved.borrow_texture(GL_TEXTURE_3D, 0);
  context.gl->BindTexture(GL_TEXTURE_3D, candidate.texture);
  const PlainSampler sampler(context, 0);
  TextureDescription now;
  return !describe_texture(context, GL_TEXTURE_3D, 0, now) && has_same_texels(now, candidate.described);
}

/// Why no request gives the whole image of a run; empty if one does.
std::string obstacle_in(const Run& run, const ImageRequest& image, const KnownVolume& volume,
                        const LiveSettings& settings) {
  if (settings.has_budget()) return "its images have the samples of --error or --time, and not the viewer's";
  if (image.request.viewport.pixels() > compositor::limits::max_window_pixels)
    return "its viewport has more pixels than an image may have";
  if (run.pipeline().stack) return "it is a stack of 2-D textures, and a scene holds one 3-D texture";
  if (is_finished_here(image, volume.march.march))
    return "the viewer's program turns what its rays find into other colours (a maximum, a mean, a background, "
           "cropping), and a scene holds what rays find";
  return {};
}

bool shows_something(const volume::ImageView& image) {
  constexpr float least_visible = 0.5F / 255;
  for (std::size_t alpha = 3; alpha < image.rgba.size(); alpha += 4) {
    if (image.rgba[alpha] > least_visible) return true;
  }
  return false;
}

}  // namespace

void SceneExport::refuse(KnownVolume& volume, GLuint texture, const std::string& reason) {
  if (volume.counters == nullptr || text_in(volume.counters->not_exported) == reason.substr(0, 199)) return;
  put_text(volume.counters->not_exported, reason);
  // A viewer may have hundreds of bricks.
  if (!said_.insert(reason).second) return;
  logging::log(logging::Level::info, "volume {} not exported: {}", texture, reason);
}

std::optional<SceneCandidate> SceneExport::candidate(const Run& run, const ImageRequest& image,
                                                     KnownVolume& volume) {
  const Options& options = session_.options();
  if (options.export_folder.empty() || volume.exported) return std::nullopt;
  const TimedShare timed(account_.clock(), nullptr);
  const GLuint texture = run.volume_texture();
  const auto same = [&](const SceneCandidate& kept) { return kept.texture == texture; };
  if (std::ranges::any_of(kept_, same)) return std::nullopt;
  if (const std::string obstacle = obstacle_in(run, image, volume, session_.settings()); !obstacle.empty()) {
    refuse(volume, texture, obstacle);
    return std::nullopt;
  }
  SceneCandidate found;
  found.texture = texture;
  found.identity = volume.identity;
  found.texture_version = volume.sent.texture_version;
  found.described = volume.sent.texture;
  found.scene.volume = volume.sent.description;
  found.scene.request = image.request;
  found.scene.request.volume = found.scene.volume.id = 1;
  found.scene.request.version = found.scene.volume.version = 1;
  found.scene.origin = {text_in(process_counters().program), account_.frames() + 1,
                        volume.sent.texture.format_name, std::nullopt};
  return found;
}

void SceneExport::look_at(SceneCandidate& candidate, const std::optional<Comparison>& comparison,
                          const volume::ImageView& shown) const {
  const TimedShare timed(account_.clock(), nullptr);
  const bool compared = session_.options().verify >= 0;
  const bool right = compared ? comparison && comparison->right && comparison->difference.anything_visible
                              : shows_something(shown);
  if (!right) return;
  candidate.image = volume::copy_of(shown);
  if (!compared) return;
  const double psnr = comparison->difference.psnr();
  if (std::isfinite(psnr)) candidate.scene.origin.psnr = psnr;
}

void SceneExport::keep(SceneCandidate candidate) {
  if (!candidate.image.rect.empty()) kept_.push_back(std::move(candidate));
}

std::string SceneExport::obstacle(const SceneCandidate& candidate, KnownVolume& volume, MergedVolumes& merged) {
  if (!group_.is(candidate.texture, candidate.identity))
    return "its texture was deleted before the frame ended";
  if (merged.is_brick(candidate.texture))
    return "its texture is a brick of a volume in several textures, and a scene holds one texture";
  if (group_.is_rendered_to(candidate.texture))
    return "its texture is rendered to, so its texels may have changed before the frame ended";
  if (group_.texture_version(candidate.texture) != candidate.texture_version)
    return retry_later(candidate, volume, "its texels were changed before the frame ended",
                       "its texels change in every frame");
  if (!is_readable(context_, candidate))
    return retry_later(
        candidate, volume,
        "its texture's definition or the pixel transfer state was changed before the frame ended",
        "its texture's definition or the pixel transfer state changes in every frame");
  in_vain_.erase(candidate.identity);
  return {};
}

std::string SceneExport::retry_later(const SceneCandidate& candidate, KnownVolume& volume, const char* reason,
                                     const char* always) {
  if (++in_vain_[candidate.identity] < max_in_vain) {
    // The next image is compared, because only then it may be exported.
    volume.verified.schedule.ask_for_whole();
    return reason;
  }
  in_vain_.erase(candidate.identity);
  volume.exported = true;
  return always;
}

std::optional<int> SceneExport::number() {
  for (int number = session_.new_scene_number(); number <= max_exported_scenes;
       number = session_.new_scene_number()) {
    if (claim_scene(session_.options().export_folder, session_.options().run_dir, number)) return number;
  }
  return std::nullopt;
}

void SceneExport::save(const SceneCandidate& candidate, KnownVolume& volume) {
  volume.exported = true;
  const std::optional<int> number = this->number();
  if (!number)
    return refuse(volume, candidate.texture,
                  fmt::format("{} volumes of this run have been exported already", max_exported_scenes));
  const SceneFiles files = scene_files(*number);
  const std::string& folder = session_.options().export_folder;
  const volume::RenderRequest& request = candidate.scene.request;
  {
    SavedState saved(context_);
    saved.borrow_texture(GL_TEXTURE_3D, 0);
    context_.gl->BindTexture(GL_TEXTURE_3D, candidate.texture);
    const auto source = texture_source(context_, candidate.texture, candidate.described);
    write_scene(folder, files, candidate.scene, *source,
                float_maps(request.viewport, candidate.image.view(), volume::neutral_value(request.op)));
  }
  put_text(volume.counters->scene, files.scene);
  put_text(volume.counters->not_exported, "");
  logging::log(logging::Level::info, "volume {} of frame {} exported: {}", candidate.texture,
               candidate.scene.origin.frame, (std::filesystem::path(folder) / files.scene).string());
}

void SceneExport::write(MergedVolumes& merged) {
  for (const SceneCandidate& candidate : std::exchange(kept_, {})) {
    KnownVolume* const volume = volumes_.find(candidate.texture);
    if (volume == nullptr || volume->identity != candidate.identity || volume->counters == nullptr) continue;
    try {
      if (const std::string reason = obstacle(candidate, *volume, merged); reason.empty())
        save(candidate, *volume);
      else
        refuse(*volume, candidate.texture, reason);
    } catch (const std::exception& error) {
      refuse(*volume, candidate.texture, error.what());
    }
  }
}

}  // namespace understudy::spu
