// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/merging/merged_texels.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "spu/volume/context/context.h"
#include "volume/texel_box.h"
#include "volume/texel_type.h"

namespace understudy::spu {
namespace {

using volume::TexelBox;

class MergedTexels final : public TexelSource {
 public:
  MergedTexels(const GlContext& context, const Tiling& tiling, std::vector<GLuint> textures,
               std::vector<TextureDescription> descriptions)
      : context_(context),
        tiling_(tiling),
        textures_(std::move(textures)),
        descriptions_(std::move(descriptions)) {
    for (std::size_t i = 0; i < textures_.size(); ++i)
      sources_.push_back(texture_source(context_, textures_[i], descriptions_[i]));
  }

  void read(const TexelBox& box, std::span<std::byte> texels) override {
    std::fill(texels.begin(), texels.end(), std::byte{0});
    const std::size_t texel = volume::bytes_per_texel(descriptions_.front().type);
    std::vector<std::byte> mine;
    std::vector<std::byte> here;
    std::vector<std::byte> there;
    std::vector<TexelBox> read;
    for (std::size_t i = 0; i < sources_.size(); ++i) {
      const TexelBox part = volume::intersection(box, tiling_.places[i].texels);
      if (volume::is_empty(part)) continue;
      TexelBox own = part;
      for (std::size_t k = 0; k < 3; ++k) {
        own.low[k] -= tiling_.places[i].origin[k];
        own.high[k] -= tiling_.places[i].origin[k];
      }
      mine.resize(volume::texels_in(part) * texel);
      context_.gl->BindTexture(GL_TEXTURE_3D, textures_[i]);
      sources_[i]->read(own, mine);
      for (const TexelBox& earlier : read) {
        const TexelBox shared = volume::intersection(earlier, part);
        if (volume::is_empty(shared)) continue;
        here.resize(volume::texels_in(shared) * texel);
        there.resize(here.size());
        volume::copy_texels(shared, texel, part, mine, shared, here);
        volume::copy_texels(shared, texel, box, texels, shared, there);
        if (here != there) throw std::runtime_error("bricks hold different texels where they overlap");
      }
      volume::copy_texels(part, texel, part, mine, box, texels);
      read.push_back(part);
    }
  }

 private:
  const GlContext& context_;
  const Tiling& tiling_;
  std::vector<GLuint> textures_;
  std::vector<TextureDescription> descriptions_;
  std::vector<std::unique_ptr<TexelSource>> sources_;
};

}  // namespace

std::unique_ptr<TexelSource> merged_source(const GlContext& context, const Tiling& tiling,
                                           std::vector<GLuint> textures,
                                           std::vector<TextureDescription> descriptions) {
  return std::make_unique<MergedTexels>(context, tiling, std::move(textures), std::move(descriptions));
}

}  // namespace understudy::spu
