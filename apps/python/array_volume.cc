// SPDX-License-Identifier: Apache-2.0
#include "apps/python/array_volume.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/understudy/file_scene/control_points_file.h"
#include "compositor/rendered.h"
#include "volume/image.h"

namespace understudy::python {

namespace {

constexpr int patience_with_nodes_ms = 60'000;
/// Size of the parts in which scalars are converted and sent.
constexpr std::size_t bytes_at_once = std::size_t(16) << 20;

class ArrayFile : public volume::VolumeFile {
 public:
  explicit ArrayFile(const Scalars& scalars) : VolumeFile(scalars.description), bytes_(scalars.bytes) {}

  void read(const volume::TexelBox& box, std::span<std::byte> scalars) override {
    const volume::TexelBox all{{0, 0, 0}, description().size};
    const std::size_t scalar = volume::bytes_per_scalar(description().type);
    volume::copy_texels(box, scalar, all, bytes_, box, scalars);
  }
  std::uint64_t bytes_read() const override { return 0; }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace

ArrayVolume::ArrayVolume(const Scalars& scalars, const std::string& nodes) : scalars_(scalars), nodes_(nodes) {
  connect();
}

void ArrayVolume::connect() {
  try {
    service_ = nodes_.empty() ? compositor::embedded_service()
                              : compositor::remote_render_service(nodes_, patience_with_nodes_ms);
  } catch (const compositor::ServiceLost& lost) {
    throw NodesLost(lost.reason());
  }
}

void ArrayVolume::load(const launcher::FileScene& scene) {
  loaded_.reset();
  const volume::VolumeDescription& description = scene.load.volume;
  service_->begin_volume(description);
  volume::TexelStream texels(std::make_unique<ArrayFile>(scalars_), scene.load.texels, description.stored);
  while (!texels.done()) {
    const auto part = texels.next(bytes_at_once);
    service_->add_texels(description.id, std::array{part.box}, part.texels);
  }
  service_->end_volume(description.id);
  figures_ = texels.figures();
  loaded_ = scene;
}

launcher::RgbaImage ArrayVolume::render(const launcher::SceneArguments& arguments,
                                        const std::string& control_points) {
  launcher::FileScene scene = scene_of(arguments, scalars_.description);
  if (!control_points.empty())
    scene.image.control_points = launcher::control_points_in(nlohmann::json::parse(control_points));
  const auto holds = [&](const launcher::FileScene& loaded) {
    return loaded.load.texels == scene.load.texels &&
           loaded.load.volume.ghost_layer >= scene.load.volume.ghost_layer;
  };
  try {
    if (!service_) connect();
    if (!loaded_ || !holds(*loaded_)) load(scene);
    return render_with(scene);
  } catch (const compositor::ServiceLost& lost) {
    loaded_.reset();
    service_.reset();
    throw NodesLost(lost.reason());
  }
}

launcher::RgbaImage ArrayVolume::render_with(const launcher::FileScene& scene) {
  const volume::RenderRequest request = request_of(scene, scene.image, figures_);
  return launcher::whole_window(service_->render(request).image, request.window);
}

}  // namespace understudy::python
