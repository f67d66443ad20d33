// SPDX-License-Identifier: Apache-2.0
// The remote unit: packed calls are made by a GL server, in another process and perhaps on another machine, and
// their answers come back (Humphreys et al. 2002; Chromium's pack and network units).
//
// Below the chain is remote_driver(), which sends the encoder's own queries the same way.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "spu/pack/record_taker.h"
#include "spu/remote/client_state.h"
#include "spu/remote/front_buffer.h"
#include "spu/remote/server_connection.h"
#include "spu/stream/encode.h"
#include "spu/trace/mapped_buffers.h"
#include "spu/unit_description.h"

namespace understudy::spu {

class Pack;

/// The driver table for a Chain: sends every command to the current chain's remote unit, if there is one.
const DispatchTable& remote_driver();

class Remote final : public Unit, public RecordTaker {
 public:
  static constexpr char tag = '~';

  Remote(Chain& chain, ServerConnection& server);

  const char* tag_address() const override { return &tag; }
  void fill(Phase, DispatchTable&) override {}
  void made_current() override;
  void left() override;
  void frame_ended(FrameEnd kind) override;
  void abandon() override;

  std::optional<std::uint64_t> known(CallId call, const std::uint64_t* words) override;
  void before(CallId call, const std::uint64_t* words, Records& to) override;
  HandOn when(CallId call, bool inside_begin) override;
  bool in_this_process() const override { return false; }
  std::uint64_t take(const Records& records, const PackedCall* last) override;

  /// Makes a query of the encoder.
  std::uint64_t ask(CallId call, const std::uint64_t* words);

 private:
  using Value = std::pair<CallId, std::uint64_t>;  ///< a query, and its argument words
  /// The application's memory of a mapped buffer.
  struct Mapping {
    std::vector<std::max_align_t> memory;
    std::uint64_t offset = 0;  ///< of its first byte in the buffer
    std::uint64_t bytes = 0;
    bool persistent = false;
    bool is_read = false;
  };

  void introduce();
  void tell_current(Records& to);
  void note_drawable(Records& to);
  void show_frame();
  bool show_front();
  void show_front_now();
  bool has_front_to_show();
  std::optional<std::uint64_t> constant(CallId call, const std::uint64_t* words) const;
  void fetch_extensions();
  std::uint64_t apply(const PackedCall& call, const CallAnswer& answer);
  void write_output(const PackedCall& call, const AnsweredOutput& output);
  std::uint64_t keep_text(const PackedCall& call, const AnsweredOutput& output);
  std::uint64_t map(const PackedCall& call, std::uint64_t bytes, const AnsweredOutput& contents);
  GLuint mapped_buffer(CallId call, const std::uint64_t* words) const;
  void drop_mappings(CallId call, const std::uint64_t* words);
  /// Returns what an application that polls must see after the GL server was lost.
  std::uint64_t lost_answer(CallId call, const std::uint64_t* words) const;
  void refresh_mappings();
  std::vector<std::byte> contents_of(GLuint buffer, const Mapping& mapping);

  Chain& chain_;
  ServerConnection& server_;
  Pack& pack_;
  Records question_records_;
  Encoder question_encoder_;
  ClientState state_;
  FrontBuffer front_;
  MappedBuffers writes_{MappedMemory::of_this_process};
  std::map<GLuint, Mapping> mappings_;  ///< by buffer
  std::map<Value, std::vector<std::byte>> constants_;
  std::map<Value, const char*> texts_;
  RecordedContext context_;
  FrontDrawable drawable_;
  std::uint64_t frames_ = 0;
  bool introduced_ = false;
  bool extensions_fetched_ = false;
  bool front_pending_ = false;  ///< an image of the front buffer may still be pending
  bool without_error_ = false;  ///< glGetError has returned GL_NO_ERROR, and no call followed
};

extern const UnitDescription remote_description;

}  // namespace understudy::spu
