// SPDX-License-Identifier: Apache-2.0
#include "spu/player/player.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "compositor/service/limits.h"
#include "spu/registry/assemble.h"
#include "spu/report/counters.h"
#include "spu/stream/event.h"
#include "spu/tiles/tile.h"
#include "spu/tiles/tiles.h"
#include "spu/track/share_group.h"
#include "spu/volume/observation/draw_observer.h"
#include "spu/volume/session/render_session.h"
#include "spu/window_system/shown_image.h"

namespace understudy::spu {
namespace {

/// Limit for the sides of a drawable in a stream.
constexpr std::uint64_t largest_side = 16384;

/// Checks the size first, because memory is allocated for the whole drawable.
bool may_be_drawable(std::uint64_t width, std::uint64_t height) {
  return width <= largest_side && height <= largest_side &&
         width * height <= compositor::limits::max_window_pixels;
}

thread_local const DispatchTable* installed = nullptr;

void install(const DispatchTable* table) {
  installed = table;
}

using Clock = std::chrono::steady_clock;

}  // namespace

/// Contexts that share objects.
struct Player::Group {
  std::shared_ptr<ShareGroup> tracked = std::make_shared<ShareGroup>();
  std::shared_ptr<ObjectNames> names = std::make_shared<ObjectNames>();
  std::vector<std::uint64_t> members;  ///< that exist in the window system
  std::uint64_t number = 0;            ///< of its first context
};

struct Player::Context {
  std::shared_ptr<Group> group;
  Decoder decoder;
  Chain chain;
  PlayedContext played;
  bool counts_frames = false;  ///< no unit of the chain counts them
  Clock::time_point frame_started = Clock::now();

  Context(std::shared_ptr<Group> share_group, const DispatchTable& driver, const RecordedContext& context,
          StreamOrigin origin)
      : group(std::move(share_group)),
        decoder(origin, group->names),
        chain(driver, group->tracked, &install, {context.number, context.shares_with}) {}
};

Player::Player(WindowSystem& windows, const Options& options, StreamOrigin origin)
    : windows_(windows),
      options_(options),
      origin_(origin),
      session_(std::make_shared<RenderSession>(options)) {}

Player::~Player() {
  if (active_ != 0) leave();
  for (auto& [number, context] : contexts_) {
    if (context) context->chain.abandon();
  }
}

Player::PlayedContext Player::current() const {
  const auto found = contexts_.find(active_);
  return found == contexts_.end() ? PlayedContext{} : found->second->played;
}

const CallAnswer& Player::call_answer() const {
  static const CallAnswer none;
  const auto found = contexts_.find(active_);
  return found == contexts_.end() ? none : found->second->decoder.call_answer();
}

const Decoder::ReadImage& Player::read_image() const {
  static const Decoder::ReadImage none;
  const auto found = contexts_.find(active_);
  return found == contexts_.end() ? none : found->second->decoder.read_image();
}

std::vector<std::uint8_t> Player::shown_image() const {
  const auto found = contexts_.find(active_);
  if (found == contexts_.end()) return {};
  if (Tiles* tiles = found->second->chain.find<Tiles>()) return tiles->shown_image();
  return spu::shown_image(driver(), active_extent_);
}

std::vector<Player::PlayedContext> Player::contexts() const {
  std::vector<PlayedContext> all;
  for (const auto& [number, context] : contexts_) all.push_back(context->played);
  return all;
}

std::uint64_t Player::here(ObjectKind kind, std::uint64_t there) const {
  const auto found = contexts_.find(active_);
  return found == contexts_.end() ? there : found->second->group->names->here(kind, there);
}

std::string Player::play(const Record& record) {
  const auto arguments = record.arguments();
  switch (record.id) {
    case event::thread:
      if (arguments.empty()) return "thread: its number is missing";
      thread_ = arguments[0];
      return {};
    case event::context:
      return introduce(record);
    case event::current:
      return make_current(record);
    case event::context_gone:
      return end_context(record);
    case event::frame:
      return end_frame(record);
    case event::front_shown:
      return show_front(record);
    default:
      return call(record);
  }
}

/// A context that was destroyed, or was never current, still identifies its group.
std::shared_ptr<Player::Group> Player::group_of(const RecordedContext& context) {
  if (context.shares_with == 0) return std::make_shared<Group>();
  auto& group = groups_[context.shares_with];
  if (!group) group = std::make_shared<Group>();
  return group;
}

std::string Player::introduce(const Record& record) {
  const auto words = record.arguments();
  if (words.size() < event::context_words) return "context: some of its properties are missing";
  const auto bits = [&](std::size_t at) { return int(std::min<std::uint64_t>(words[at], 64)); };
  RecordedContext context{.number = words[0],
                          .shares_with = words[1],
                          .version = int(std::min<std::uint64_t>(words[3], 1000)),
                          .profile = std::uint32_t(words[4]),
                          .red = bits(5),
                          .green = bits(6),
                          .blue = bits(7),
                          .alpha = bits(8),
                          .depth = bits(9),
                          .stencil = bits(10),
                          .samples = bits(11),
                          .double_buffered = words[12] != 0};
  if (context.number == 0 || contexts_.contains(context.number))
    return fmt::format("context: its number {} is taken", context.number);
  const std::shared_ptr<Group> group = group_of(context);
  context.shares_with = group->members.empty() ? 0 : group->members.front();
  windows_.create(context);
  group->members.push_back(context.number);
  groups_[context.number] = group;
  auto made = std::make_unique<Context>(group, windows_.driver(), context, origin_);
  if (const auto trouble = assemble(made->chain, options_.chain, session_)) throw std::runtime_error(*trouble);
  if (Tiles* tiles = made->chain.find<Tiles>()) tiles->introduce(words.first(event::context_words));
  if (group->number == 0) group->number = context.number;
  made->played = {context.number, group->number, {}};
  made->counts_frames = made->chain.find<DrawObserver>() == nullptr;
  contexts_[context.number] = std::move(made);
  return {};
}

std::string Player::make_current(const Record& record) {
  const auto words = record.arguments();
  if (words.size() < 3) return "current: some of its words are missing";
  Thread& thread = threads_[thread_];
  if (words[0] == 0) {
    if (thread.context != 0 && thread.context == active_) leave();
    thread.context = 0;
    return {};
  }
  const auto found = contexts_.find(words[0]);
  if (found == contexts_.end()) return fmt::format("current: there is no context {}", words[0]);
  if (!may_be_drawable(words[1], words[2]))
    return fmt::format("current: a drawable of {} x {} pixels is larger than windows are", words[1], words[2]);
  const auto side = [](std::uint64_t pixels) { return int(std::max<std::uint64_t>(pixels, 1)); };
  const Thread wanted{words[0], words.size() > 3 ? words[3] : 0, {side(words[1]), side(words[2])}};
  if (thread.context != 0 && thread.context != wanted.context && thread.context == active_) leave();
  thread = wanted;
  activate();
  return {};
}

void Player::leave() {
  const auto found = contexts_.find(active_);
  if (found != contexts_.end()) {
    found->second->chain.settle();
    found->second->chain.frame_ended(FrameEnd::make_current);
  }
  Chain::release_current();
  windows_.release_current();
  active_ = 0;
}

Player::Context* Player::activate() {
  const Thread& thread = threads_[thread_];
  const auto found = contexts_.find(thread.context);
  if (found == contexts_.end()) return nullptr;
  if (active_ == thread.context && active_drawable_ == thread.drawable && active_extent_ == thread.extent)
    return found->second.get();
  if (active_ != 0) contexts_[active_]->chain.settle();
  if (active_ != thread.context) Chain::release_current();
  windows_.make_current(thread.context, thread.drawable, thread.extent);
  Chain& chain = found->second->chain;
  if (Tiles* tiles = chain.find<Tiles>()) tiles->place(thread.drawable, thread.extent);
  if (Tile* tile = chain.find<Tile>()) tile->place(thread.extent);
  if (active_ != thread.context) chain.make_current();
  active_ = thread.context;
  active_drawable_ = thread.drawable;
  active_extent_ = thread.extent;
  found->second->played.drawable = thread.extent;
  return found->second.get();
}

std::string Player::end_context(const Record& record) {
  const auto words = record.arguments();
  const auto found = words.empty() ? contexts_.end() : contexts_.find(words[0]);
  if (found == contexts_.end()) return "context_gone: there is no such context";
  const std::uint64_t number = found->first;
  if (active_ == number) leave();
  for (auto& [name, thread] : threads_) {
    if (thread.context == number) thread.context = 0;
  }
  found->second->chain.abandon();
  const std::shared_ptr<Group> group = found->second->group;
  contexts_.erase(found);
  // Later contexts may share objects with this one, so the last context of a group is kept.
  if (group->members.size() == 1) return {};
  std::erase(group->members, number);
  windows_.destroy(number);
  return {};
}

std::string Player::end_frame(const Record& record) {
  const auto words = record.arguments();
  if (words.size() < 3) return "frame: some of its words are missing";
  Context* context = activate();
  if (context == nullptr) return "frame: its thread has no context";
  context->chain.settle();
  const auto side = [](std::uint64_t pixels) { return int(std::min<std::uint64_t>(pixels, largest_side)); };
  if (on_frame) on_frame({words[0], {side(words[1]), side(words[2])}});
  if (context->counts_frames) {
    const auto now = Clock::now();
    count_frame({.time_ms = std::chrono::duration<double, std::milli>(now - context->frame_started).count(),
                 .error_rms = -1});
    context->frame_started = now;
  }
  context->chain.frame_ended(FrameEnd::swap);
  return {};
}

std::string Player::show_front(const Record& record) {
  const auto words = record.arguments();
  if (origin_ != StreamOrigin::linked || words.size() < 2) return "front_shown: is of no linked stream";
  Context* context = activate();
  if (context == nullptr) return "front_shown: its thread has no context";
  context->chain.settle();
  const auto side = [](std::uint64_t pixels) { return int(std::min<std::uint64_t>(pixels, largest_side)); };
  if (on_frame) on_frame({0, {side(words[0]), side(words[1])}});
  return {};
}

std::string Player::call(const Record& record) {
  Context* context = activate();
  if (context == nullptr) return "a call of a thread without a context";
  Decoded decoded = context->decoder.decode(record, *installed);
  if (on_read && !context->decoder.read_image().pixels.empty()) on_read(context->decoder.read_image());
  return std::move(decoded.error);
}

}  // namespace understudy::spu
