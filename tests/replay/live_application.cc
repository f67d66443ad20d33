// SPDX-License-Identifier: Apache-2.0
#include "live_application.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <stdexcept>

#include "spu/player/player.h"
#include "spu/registry/assemble.h"
#include "spu/stream/trace_file.h"
#include "spu/track/share_group.h"
#include "spu/window_system/shown_image.h"

#if defined(__SANITIZE_ADDRESS__)
/// Suppresses leak reports for memory that Mesa keeps until the process ends.
extern "C" [[gnu::visibility("default")]] const char* __lsan_default_suppressions();
const char* __lsan_default_suppressions() {
  return "leak:_dri.so\nleak:libEGL_mesa\nleak:libLLVM\n";
}
#endif

namespace understudy::replay_test {
namespace {

thread_local const spu::DispatchTable* installed = nullptr;

void install(const spu::DispatchTable* table) {
  installed = table;
}

}  // namespace

std::filesystem::path trace_of_this_test() {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  std::filesystem::path path = std::filesystem::path(testing::TempDir()) /
                               fmt::format("{}.{}.{}.ust", test->test_suite_name(), test->name(), ::getpid());
  std::filesystem::remove(path);
  return path;
}

spu::RecordedContext compatibility_context(std::uint64_t number, std::uint64_t shares_with) {
  return {.number = number,
          .shares_with = shares_with,
          .version = 450,
          .profile = GL_CONTEXT_COMPATIBILITY_PROFILE_BIT};
}

spu::RecordedContext core_context(std::uint64_t number) {
  return {.number = number, .version = 450, .profile = GL_CONTEXT_CORE_PROFILE_BIT};
}

LiveApplication::LiveApplication(std::filesystem::path trace) : trace_(std::move(trace)) {}

LiveApplication::~LiveApplication() {
  end();
  std::filesystem::remove(trace_);
}

void LiveApplication::add(const spu::RecordedContext& context) {
  windows_.create(context);
  auto chain = std::make_unique<spu::Chain>(windows_.driver(), std::make_shared<spu::ShareGroup>(), &install,
                                            spu::Surroundings{context.number, context.shares_with});
  if (const auto trouble =
          spu::assemble(*chain, fmt::format("trace(file=\"{}\") driver", trace_.string()), nullptr)) {
    throw std::runtime_error(*trouble);
  }
  chains_[context.number] = std::move(chain);
  make_current(context.number);
}

void LiveApplication::make_current(std::uint64_t context) {
  spu::Chain::release_current();
  windows_.make_current(context, 0, extent);
  chains_.at(context)->make_current();
}

const spu::DispatchTable& LiveApplication::gl() const {
  return *installed;
}

void LiveApplication::show() {
  shown_.push_back(spu::shown_image(windows_.driver(), extent));
  spu::Chain::current()->frame_ended(spu::FrameEnd::swap);
}

void LiveApplication::end() {
  if (chains_.empty()) return;
  spu::Chain::release_current();
  windows_.release_current();
  for (auto& [number, chain] : chains_) chain->abandon();
  chains_.clear();
}

Played play_back(const std::filesystem::path& trace, const std::string& chain) {
  launcher::EglContexts windows;
  spu::Options options;
  options.speed_guard = false;
  options.chain = chain;
  spu::Player player(windows, options);
  Played played;
  player.on_frame = [&](const spu::ShownFrame& frame) {
    played.frames.push_back(spu::shown_image(windows.driver(), frame.extent));
  };
  player.on_read = [&](const spu::Decoder::ReadImage& read) {
    const auto* first = reinterpret_cast<const std::uint8_t*>(read.pixels.data());
    played.reads.emplace_back(first, first + read.pixels.size());
  };
  spu::TraceReader reader(trace);
  while (const auto block = reader.next()) {
    std::size_t position = 0;
    while (const auto record = spu::record_at(block->records, position, block->payload)) {
      if (std::string error = player.play(*record); !error.empty())
        played.errors.push_back(in_block(*block, error));
      position += record->words.size();
    }
  }
  return played;
}

}  // namespace understudy::replay_test
