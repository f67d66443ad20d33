// The volume unit's way for volumes that lie in many textures: runs wait for each other, and are shown as one.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "spu/volume/context/saved_state.h"
#include "spu/volume/depth/depth.h"
#include "spu/volume/merging/merged_texels.h"
#include "spu/volume/merging/merging.h"
#include "spu/volume/upload/texel_transfer.h"
#include "spu/volume/verification/tile_comparison.h"
#include "volume/footprint.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::spu {
namespace {

/// In so many frames the whole must have been shown before the nodes forget the bricks.
constexpr std::uint64_t frames_before_bricks_go = 16;
constexpr std::uint64_t longest_pause = 1024;
/// Looking at all pairs of bricks would take longer than drawing them one by one.
constexpr std::size_t most_bricks = 1024;

bool alike(const TextureDescription& a, const TextureDescription& b) {
  return a.type == b.type && a.base == b.base && a.opaque == b.opaque && a.grey == b.grey &&
         a.filter == b.filter && a.wrap == b.wrap && a.border == b.border && a.swizzle == b.swizzle;
}

bool alike(const Target& a, const Target& b) {
  return a.alpha_bits == b.alpha_bits && a.normalised == b.normalised && a.floating == b.floating &&
         a.samples == b.samples;
}

/// Whether two runs' images go the same way into the framebuffer, in the same colours.
bool alike(const Pipeline& a, const volume::RenderRequest& first, const Pipeline& b,
           const volume::RenderRequest& second) {
  return a.blending == b.blending && alike(a.target, b.target) && a.depth_test == b.depth_test &&
         a.depth_or_equal == b.depth_or_equal && first.viewport == second.viewport &&
         first.window == second.window && first.depth_range == second.depth_range && first.op == second.op &&
         first.clip_planes.size() == second.clip_planes.size() && first.classification == second.classification;
}

/// The half-space of a brick's texture space in the volume's.
volume::HalfSpace carried(const volume::HalfSpace& plane, const PlaceMap& map) {
  volume::HalfSpace moved{{}, plane.offset};
  for (std::size_t k = 0; k < 3; ++k) {
    moved.normal[k] = plane.normal[k] / map.scale[k];
    moved.offset -= moved.normal[k] * map.offset[k];
  }
  return moved;
}

/// Polygons of all bricks, in the volume's texture space, in the order in which their planes lie along `axis`.
class AllPolygons {
 public:
  void add(const ObservedPolygons& polygons, const PlaceMap& map, const volume::Vec3& axis) {
    clipped_ = clipped_ || polygons.clipped;
    for (std::size_t p = 0; p < polygons.count(); ++p) {
      Polygon polygon{vertices_.size(), 0, 0};
      for (ObservedVertex vertex : polygons.polygon(p)) {
        vertex.texture = map(vertex.texture);
        for (std::size_t k = 0; k < 3; ++k) polygon.place += axis[k] * vertex.texture[k];
        vertices_.push_back(vertex);
      }
      polygon.count = vertices_.size() - polygon.first;
      if (polygon.count == 0) continue;
      polygon.place /= double(polygon.count);
      polygons_.push_back(polygon);
    }
  }

  ObservedPolygons sorted() {
    std::sort(polygons_.begin(), polygons_.end(),
              [](const Polygon& a, const Polygon& b) { return a.place < b.place; });
    ObservedPolygons all;
    all.clipped = clipped_;
    all.vertices.reserve(vertices_.size());
    for (const Polygon& polygon : polygons_) {
      const auto first = vertices_.begin() + std::ptrdiff_t(polygon.first);
      all.vertices.insert(all.vertices.end(), first, first + std::ptrdiff_t(polygon.count));
      all.first.push_back(all.vertices.size());
    }
    return all;
  }

 private:
  struct Polygon {
    std::size_t first;
    std::size_t count;
    double place;
  };
  std::vector<ObservedVertex> vertices_;
  std::vector<Polygon> polygons_;
  bool clipped_ = false;
};

/// Binds a run's texture where it was bound when it was drawn; sampler objects stay.
class BoundAgain {
 public:
  BoundAgain(const DispatchTable& gl, const SampledTexture& sampled) : gl_(gl), unit_(sampled.unit) {
    gl_.GetIntegerv(GL_ACTIVE_TEXTURE, &active_);
    gl_.ActiveTexture(GLenum(GL_TEXTURE0 + unit_));
    gl_.GetIntegerv(GL_TEXTURE_BINDING_3D, &bound_);
    gl_.BindTexture(GL_TEXTURE_3D, sampled.texture);
  }
  ~BoundAgain() {
    gl_.ActiveTexture(GLenum(GL_TEXTURE0 + unit_));
    gl_.BindTexture(GL_TEXTURE_3D, GLuint(bound_));
    gl_.ActiveTexture(GLenum(active_));
  }
  BoundAgain(const BoundAgain&) = delete;
  BoundAgain& operator=(const BoundAgain&) = delete;

 private:
  const DispatchTable& gl_;
  int unit_;
  GLint active_ = 0;
  GLint bound_ = 0;
};

}  // namespace

std::optional<std::size_t> MergedVolume::place_of(GLuint texture) const {
  const auto found = std::find(textures.begin(), textures.end(), texture);
  if (found == textures.end()) return std::nullopt;
  return std::size_t(found - textures.begin());
}

MergedVolume* VolumeUnit::Merging::volume_with(GLuint texture) const {
  for (const auto& merged : volumes) {
    if (merged->place_of(texture)) return merged.get();
  }
  return nullptr;
}

void VolumeUnit::note_brick(const Substitution& s) {
  Merging& merging = *merging_;
  const bool plain = !s.proxy && !s.pipeline.stack && !s.request.slice_segment && !s.request.fog &&
                     !(s.pipeline.depth_test && s.pipeline.depth_write);
  if (!plain) return;
  const GLuint texture = s.pipeline.volume.texture;
  const TextureDescription& description = s.volume.texture;
  volume::TexelBox& shown = merging.shown[texture];
  shown = volume::enclosing(volume::intersection(shown, {{0, 0, 0}, description.size}),
                            texels_read(s.slices.region, description.size, description.filter));
  const DrawnBrick brick{description.size, s.fit->texture_to_clip, s.slices.region, shown};
  for (Merging::Group& group : merging.groups) {
    const auto first = known_.find(group.textures.front());
    if (first == known_.end() || !first->second.probed) continue;
    // A table over float values spans those of its own brick.
    const bool same_colours = description.type == volume::TexelType::f32 ||
                              first->second.probed->classification == s.request.classification;
    if (group.type != description.type || !same_colours || group.textures.size() >= most_bricks ||
        std::find(group.textures.begin(), group.textures.end(), texture) != group.textures.end() ||
        !lattice_offset(group.bricks.front(), brick))
      continue;
    group.textures.push_back(texture);
    group.bricks.push_back(brick);
    return;
  }
  merging.groups.push_back({{texture}, {brick}, description.type});
}

void VolumeUnit::find_merged_volumes() {
  Merging& merging = *merging_;
  const std::vector<Merging::Group> groups = std::exchange(merging.groups, {});
  const std::uint64_t frame = session_->ledger().frames();
  if (frame < merging.next_search) return;
  for (const Merging::Group& group : groups) {
    if (group.textures.size() < 2) continue;
    const bool all_known = std::all_of(group.textures.begin(), group.textures.end(), [&](GLuint texture) {
      const auto found = known_.find(texture);
      return found != known_.end() && found->second.handed_back.empty();
    });
    const MergedVolume* const before = merging.volume_with(group.textures.front());
    if (!all_known || (before != nullptr && before->textures.size() >= group.textures.size())) continue;
    const TextureDescription& first = known_[group.textures.front()].texture;
    auto merged = std::make_unique<MergedVolume>();
    merged->textures = group.textures;
    merged->volume.range = known_[group.textures.front()].range;
    for (const GLuint texture : group.textures) {
      const KnownVolume& brick = known_[texture];
      if (!alike(brick.texture, first)) break;
      merged->descriptions.push_back(brick.texture);
      merged->versions.push_back(brick.texture_version);
      merged->shown.push_back(merging.shown[texture]);
      merged->volume.range[0] = std::min(merged->volume.range[0], brick.range[0]);
      merged->volume.range[1] = std::max(merged->volume.range[1], brick.range[1]);
    }
    if (merged->descriptions.size() < group.textures.size()) continue;
    auto tiling = find_tiling(group.bricks, first.filter, first.wrap);
    if (!std::holds_alternative<Tiling>(tiling)) continue;
    merged->tiling = std::get<Tiling>(std::move(tiling));
    for (const GLuint texture : group.textures) forget_merged_volume(texture);
    merged->volume.texture = first;
    merged->volume.texture.size = merged->tiling.size;
    std::vector<VolumeCounters*> counters;
    for (const GLuint texture : group.textures) counters.push_back(known_[texture].counters);
    merged->volume.counters = &count_as_one(counters);
    for (const GLuint texture : group.textures) {
      known_[texture].counters = merged->volume.counters;
    }
    merging.volumes.push_back(std::move(merged));
  }
}

void VolumeUnit::forget_merged_volume(GLuint texture) {
  const MergedVolume* const merged = merging_->volume_with(texture);
  if (merged == nullptr) return;
  if (merged->volume.generation != 0) {
    const auto lock = session_->lock();
    if (merged->volume.generation == session_->generation()) session_->forget(merged->volume.description.id);
  }
  std::erase_if(merging_->volumes, [&](const auto& each) { return each.get() == merged; });
}

void VolumeUnit::forget_deleted_bricks() {
  Merging& merging = *merging_;
  std::vector<GLuint> gone;
  for (const auto& [texture, shown] : merging.shown) {
    if (!chain_.group().remembers(texture)) gone.push_back(texture);
  }
  for (const GLuint texture : gone) {
    merging.shown.erase(texture);
    const MergedVolume* const merged = merging.volume_with(texture);
    if (merged == nullptr) continue;
    leave_behind(*merged->volume.counters);
    // Bricks that are left count for themselves again.
    for (const GLuint other : merged->textures) {
      const auto brick = known_.find(other);
      if (brick != known_.end()) brick->second.counters = nullptr;
    }
    forget_merged_volume(texture);
  }
}

bool VolumeUnit::holds(std::unique_ptr<Run>& run, Substitution& s) {
  Merging& merging = *merging_;
  const GLuint texture = s.pipeline.volume.texture;
  MergedVolume* const merged = s.pipeline.stack || s.proxy ? nullptr : merging.volume_with(texture);
  if (merged == nullptr || !merged->handed_back.empty() || s.volume.frames == 0 || depth_watched_ != 0 ||
      (s.pipeline.depth_test && s.pipeline.depth_write))
    return false;
  const std::size_t place = *merged->place_of(texture);
  {
    // Without nodes the application draws: what waits is not waited with.
    const auto lock = session_->lock();
    process_counters().nodes = session_->service().nodes();
  }
  describe_volume(s);
  volume::TexelBox& shown = merging.shown[texture];
  const volume::TexelBox read = texels_read(s.slices.region, s.volume.texture.size, s.volume.texture.filter);
  const bool floats = s.volume.texture.type == volume::TexelType::f32;
  if (!alike(s.volume.texture, merged->descriptions[place]) ||
      s.volume.texture.size != merged->descriptions[place].size ||
      !volume::contains(merged->shown[place], read) ||
      (floats && s.texture_version != merged->versions[place])) {
    // Another texture than was known, more of it, or values that no table was probed for: learnt anew.
    settle_held();
    forget_merged_volume(texture);
    shown = volume::enclosing(shown, read);
    // Of this frame's bricks some have been shown already, and are not noted.
    merging.next_search = session_->ledger().frames() + 1 + merging.pause;
    merging.pause = std::min(2 * merging.pause, longest_pause);
    return false;
  }
  if (floats) s.volume.range = merged->volume.range;
  classify(s);
  if (s.request.slice_segment || s.request.fog) return false;
  compose_request(s);
  const auto same_texture = [&](const HeldRun& other) { return other.s.pipeline.volume.texture == texture; };
  if (!merging.held.empty() &&
      (merging.held_volume != merged || std::any_of(merging.held.begin(), merging.held.end(), same_texture) ||
       !alike(merging.held.front().s.pipeline, merging.held.front().s.request, s.pipeline, s.request)))
    settle_held();
  if (merging.held.empty())
    merged->volume.verification.begin(s.inputs, intersection(s.request.window, s.request.viewport).pixels());
  const int verify = session_->options().verify;
  const bool verified = (merged->volume.verification.whole_due() && verify >= 0) ||
                        (verify > 0 && merged->volume.frames % std::uint64_t(verify) == 0);
  if (verified) {
    const TimedShare timed(clock_, &FrameShares::verification);
    if (merging.held.empty()) {
      volume::RenderRequest request = s.request;
      if (s.pipeline.depth_test)
        request.depth = read_depth(context(), s.pipeline.target, request.window, s.pipeline.depth_or_equal);
      merging.drawn = std::make_unique<NativeDrawing>(context(), s.pipeline, request);
    }
    if (merging.drawn) merging.drawn->add(*run);
  }
  merging.held_volume = merged;
  merging.held.push_back({std::move(run), std::move(s)});
  if (merging.held.size() == merged->textures.size()) settle_held();
  return true;
}

void VolumeUnit::settle_held() {
  Merging& merging = *merging_;
  if (merging.held.empty()) return;
  {
    const TimedShare timed(clock_, &FrameShares::recognition);
    std::vector<HeldRun> held = std::exchange(merging.held, {});
    MergedVolume& merged = *merging.held_volume;
    if (!run_) chain_.set_phase(resting_phase());
    const bool all = held.size() == merged.textures.size();
    if (!all || !shows_as_one(merged, held)) {
      for (HeldRun& each : held) show_alone(each.s);
    }
    merging.drawn.reset();
  }
  note([spent = clock_.take()](FrameRecord& frame) { frame.spent_ms += spent; });
}

bool VolumeUnit::shows_as_one(MergedVolume& merged, std::vector<HeldRun>& held) {
  try {
    Substitution whole{.run = *held.front().run, .pipeline = held.front().s.pipeline, .volume = merged.volume};
    compose_merged_request(merged, held, whole);
    const auto lock = session_->lock();
    compositor::RenderService& service = session_->service();
    upload_merged(merged, held, service);
    whole.request.volume = merged.volume.description.id;
    whole.request.version = merged.volume.description.version;
    const volume::FrameCounts counts = show(service, whole, [&](const volume::ImageView& image) {
      if (!merging_->drawn || !merging_->drawn->complete()) return;
      const TimedShare timed(clock_, &FrameShares::verification);
      const volume::Rect window = intersection(whole.request.window, whole.request.viewport);
      judge(merged.volume, difference_between(whole.pipeline, merging_->drawn->image(window), image), 0);
    });
    for (std::size_t k = 0; k < 3; ++k) merged.volume.counters->size[k] = merged.tiling.size[k];
    if (merged.volume.frames == 0 || session_->options().explain)
      explain(whole, fmt::format("merged of {} textures: ", merged.textures.size()));
    for (const HeldRun& each : held) ++each.s.volume.frames;
    if (++merged.volume.frames == frames_before_bricks_go) forget_single_bricks(merged);
    count_substituted(merged.volume, counts);
    return true;
  } catch (const Refusal& refusal) {
    merged.handed_back = refusal.reason;
  } catch (const compositor::ServiceLost& lost) {
    const auto lock = session_->lock();
    session_->lost(lost);
    return false;
  } catch (const std::exception& error) {
    merged.handed_back = error.what();
  }
  fmt::print(stderr, "understudy: {} textures of one volume are shown one by one: {}\n", merged.textures.size(),
             merged.handed_back);
  return false;
}

void VolumeUnit::compose_merged_request(MergedVolume& merged, const std::vector<HeldRun>& held,
                                        Substitution& whole) {
  const Substitution& first = held.front().s;
  whole.request = first.request;
  std::vector<PlaceMap> maps;
  for (const HeldRun& each : held) {
    const std::size_t place = *merged.place_of(each.s.pipeline.volume.texture);
    maps.push_back(map_of(merged.tiling, place, merged.descriptions[place].size));
  }
  const SliceOrder order = order_of(whole.pipeline);
  // The way of the planes through the whole, towards the eye or from it.
  const double sign = (order == SliceOrder::front_to_back ? 1 : -1) * first.slices.planes.spacing;
  volume::Vec3 axis{};
  for (std::size_t k = 0; k < 3; ++k) axis[k] = sign * first.slices.planes.normal[k] / maps.front().scale[k];

  AllPolygons polygons;
  std::vector<volume::Box> regions;
  for (std::size_t i = 0; i < held.size(); ++i) {
    polygons.add(held[i].s.polygons, maps[i], axis);
    const volume::Box& region = held[i].s.slices.region;
    regions.push_back({maps[i](region.low), maps[i](region.high)});
  }
  whole.polygons = polygons.sorted();
  whole.fit = fit_camera(whole.polygons.vertices);
  if (!whole.fit || whole.fit->residual > max_fit_residual)
    throw Refusal{"the bricks have no camera in common"};
  for (volume::HalfSpace& plane : whole.request.clip_planes) plane = carried(plane, maps.front());
  SliceFinding finding = find_slices(whole.polygons, *whole.fit, whole.request.clip_planes, order);
  if (const auto* reason = std::get_if<std::string>(&finding))
    throw Refusal{"of the bricks together, " + *reason};
  whole.slices = std::get<SliceSet>(finding);
  if (order != SliceOrder::any && !drawn_in_order(regions, whole.fit->texture_to_clip, whole.slices.planes,
                                                  order == SliceOrder::back_to_front))
    throw Refusal{"the bricks are not drawn in the order in which they lie"};
  whole.request.texture_to_clip = whole.fit->texture_to_clip;
  whole.request.planes = whole.slices.planes;
  whole.request.region = whole.slices.region;
  hide_behind_geometry(whole);
}

void VolumeUnit::upload_merged(MergedVolume& merged, const std::vector<HeldRun>& held,
                               compositor::RenderService& service) {
  KnownVolume& whole = merged.volume;
  const bool kept = whole.generation == session_->generation();
  std::vector<std::uint64_t> versions = merged.versions;
  std::vector<volume::TexelBox> changed;
  for (const HeldRun& each : held) {
    const GLuint texture = each.s.pipeline.volume.texture;
    const std::size_t i = *merged.place_of(texture);
    versions[i] = each.s.texture_version;
    if (versions[i] == merged.versions[i]) continue;
    const volume::TexelBox all{{0, 0, 0}, merged.descriptions[i].size};
    const auto told = chain_.group().changes_since(texture, merged.versions[i]);
    for (volume::TexelBox box : told ? *told : std::vector{all}) {
      for (std::size_t k = 0; k < 3; ++k) {
        box.low[k] += merged.tiling.places[i].origin[k];
        box.high[k] += merged.tiling.places[i].origin[k];
      }
      box = volume::intersection(box, merged.tiling.places[i].texels);
      if (!volume::is_empty(box)) changed.push_back(box);
    }
  }
  const bool everything = session_->disabled_optimizations(Optimization::unchanged_texels);
  if (kept && changed.empty() && !everything) {
    note([&](FrameRecord& frame) {
      frame.amount(Optimization::unchanged_texels).left_out +=
          volume::texels_in(whole.description.stored) * volume::bytes_per_texel(whole.description.type);
    });
    merged.versions = std::move(versions);
    return;
  }
  const TimedShare timed(clock_, &FrameShares::upload);
  whole.generation = 0;
  volume::VolumeDescription wanted = whole.description;
  wanted.size = merged.tiling.size;
  wanted.type = whole.texture.type;
  wanted.wrap = whole.texture.wrap;
  wanted.border = whole.texture.border;
  wanted.stored = {{0, 0, 0}, wanted.size};
  if (session_->options().has_budget()) wanted.ghost_layer = budget_ghost_layer;
  if (wanted.id == 0) wanted.id = session_->new_volume_id();
  Transferred transferred;
  try {
    SavedState saved(context());
    const SampledTexture& sampled = held.front().s.pipeline.volume;
    saved.borrow_texture(GL_TEXTURE_3D, sampled.unit);
    const auto source = merged_source(context(), merged.tiling, merged.textures, merged.descriptions);
    if (kept && !everything) {
      transferred = send_changes(service, wanted, changed, *source, whole.hashes);
    } else {
      ++wanted.version;
      whole.hashes = BlockHashes(wanted.stored, wanted.type);
      transferred = send_volume(service, wanted, *source, whole.hashes);
    }
  } catch (const std::runtime_error&) {
    // Texels have come in part only.
    session_->forget(wanted.id);
    throw;
  }
  whole.description = wanted;
  whole.generation = session_->generation();
  merged.versions = std::move(versions);
  count_transferred(*whole.counters, transferred,
                    everything ? "asked to"
                    : kept     ? "a texture was written to"
                               : "the nodes do not have them");
}

void VolumeUnit::forget_single_bricks(const MergedVolume& merged) {
  for (const GLuint texture : merged.textures) {
    KnownVolume& brick = known_[texture];
    if (brick.generation == session_->generation()) session_->forget(brick.description.id);
    brick.generation = 0;
  }
}

void VolumeUnit::show_alone(Substitution& s) {
  const auto unverified = [](const volume::ImageView&) {};
  const DispatchTable& gl = *context().gl;
  hide_behind_geometry(s);
  try {
    const auto lock = session_->lock();
    compositor::RenderService& service = session_->service();
    {
      const BoundAgain bound(gl, s.pipeline.volume);
      upload(s, service);
    }
    s.request.volume = s.volume.description.id;
    s.request.version = s.volume.description.version;
    const volume::FrameCounts counts = show(service, s, unverified);
    ++s.volume.frames;
    count_substituted(s.volume, counts);
    return;
  } catch (const compositor::ServiceLost& lost) {
    const auto lock = session_->lock();
    session_->lost(lost);
  } catch (const Refusal&) {
    // The texture cannot be read as it was: the last way tells why.
  } catch (const std::exception&) {
    // Refused, for want of memory perhaps: below it is told what the last way came to.
  }
  // The run's calls are gone, and whatever could be seen of it is about to be: it is rendered here.
  try {
    const auto service = compositor::embedded_service();
    volume::VolumeDescription description = s.volume.description;
    description.size = s.volume.texture.size;
    description.type = s.volume.texture.type;
    description.wrap = s.volume.texture.wrap;
    description.border = s.volume.texture.border;
    description.stored = {{0, 0, 0}, description.size};
    description.id = 1;
    {
      const SavedState saved(context());
      const BoundAgain bound(gl, s.pipeline.volume);
      BlockHashes hashes(description.stored, description.type);
      const auto source = texture_source(context(), s.pipeline.volume.texture, s.volume.texture);
      send_volume(*service, description, *source, hashes);
    }
    s.request.volume = description.id;
    s.request.version = description.version;
    count_substituted(s.volume, show(*service, s, unverified));
  } catch (const std::exception& error) {
    s.volume.handed_back = error.what();
    leave(s.pipeline.volume.texture, error.what());
  }
}

}  // namespace understudy::spu
