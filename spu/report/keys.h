// SPDX-License-Identifier: Apache-2.0
// The names in the JSON report, defined only here. Readers of reports rely on them: keys may be added, but
// never renamed.
#pragma once

namespace understudy::spu::report_key {

// The run, summed over its processes.
constexpr const char* frames = "frames";
constexpr const char* frames_substituted = "frames_substituted";
constexpr const char* frames_left = "frames_left";
constexpr const char* nodes = "nodes";
constexpr const char* backends = "backends";  ///< of the nodes of this run: what cast the rays, and why
constexpr const char* origin = "origin";      ///< of `understudy run`: version, command, machine, time
constexpr const char* remote = "remote";      ///< whether a GL server executed the viewer's OpenGL stream
constexpr const char* images_behind = "images_behind";  ///< --frame-latency: shown one frame late
constexpr const char* windows_asked = "windows_asked";  ///< how often a window was asked to redraw for that
constexpr const char* processes = "processes";
constexpr const char* time_ms = "time_ms";
constexpr const char* left_out = "left_out";  ///< {what: amount}
constexpr const char* frames_detail = "frames_detail";
constexpr const char* volumes = "volumes";

// server_connection: null unless remote. Sums over all processes of the run; per_frame are means.
constexpr const char* server_connection = "server_connection";
constexpr const char* round_trips = "round_trips";
constexpr const char* bytes_up = "bytes_up";
constexpr const char* bytes_down = "bytes_down";
constexpr const char* per_frame = "per_frame";
constexpr const char* lost =
    "lost";  ///< the GL server ended before the viewer; in verify: comparisons beyond the bound of a tile
constexpr const char* frames_lost = "frames_lost";  ///< ended but never shown because of that

// tiles: null unless --tiles on, on this machine.
constexpr const char* tiles = "tiles";
constexpr const char* of = "of";              ///< number of tiles of a window
constexpr const char* given_up = "given_up";  ///< why one process drew whole windows from some frame on

// connection: null unless --connect HOST:PORT. Sums over all connections of the run: traffic over TCP.
constexpr const char* connection = "connection";
constexpr const char* address = "address";
constexpr const char* connections = "connections";      ///< number of connections
constexpr const char* up = "up";                        ///< {messages, payload_bytes, bytes, blocks}
constexpr const char* down = "down";                    ///< {messages, payload_bytes, bytes}
constexpr const char* payload_bytes = "payload_bytes";  ///< before compression
constexpr const char* blocks = "blocks";                ///< {none, lz4, zstd}: their compression
constexpr const char* round_trip_ms = "round_trip_ms";  ///< as the kernel measures it
constexpr const char* bytes_per_second_up = "bytes_per_second_up";  ///< likewise

// processes[]
constexpr const char* pid = "pid";
constexpr const char* program = "program";
constexpr const char* calls = "calls";

// time_ms: medians over all frames, over those with a substituted volume, and over those with native rendering
// of all volumes.
constexpr const char* frame_median = "frame_median";
constexpr const char* substituted_median = "substituted_median";
constexpr const char* application_median = "application_median";
constexpr const char* waiting_median = "waiting_median";  ///< of substituted frames, like the following
constexpr const char* recognition_median = "recognition_median";
constexpr const char* depth_median = "depth_median";
constexpr const char* budget_median = "budget_median";

// left_out
constexpr const char* samples_skipped = "samples_skipped";
constexpr const char* rays_ended_early = "rays_ended_early";
constexpr const char* blocks_empty = "blocks_empty";
constexpr const char* nodes_idle = "nodes_idle";
constexpr const char* items =
    "items";  ///< {optimization: {unit, left_out, done, because}}; for a frame {optimization: left_out}
constexpr const char* unit = "unit";
constexpr const char* done = "done";
constexpr const char* because = "because";  ///< {reason: count}: why work was done

// exchanged: between nodes, to composite images
constexpr const char* exchanged = "exchanged";
constexpr const char* bytes = "bytes";
constexpr const char* messages = "messages";
constexpr const char* bytes_of_whole_windows = "bytes_of_whole_windows";        ///< without footprints
constexpr const char* messages_of_whole_windows = "messages_of_whole_windows";  ///< likewise

// frames_detail[]
constexpr const char* frame = "frame";
constexpr const char* time = "time_ms";
constexpr const char* waiting_time = "waiting_ms";
constexpr const char* recognition_time = "recognition_ms";
constexpr const char* depth_time = "depth_ms";
constexpr const char* upload_time = "upload_ms";
constexpr const char* render_time = "render_ms";
constexpr const char* verification_time = "verification_ms";
constexpr const char* presentation_time = "presentation_ms";
constexpr const char* budget_time = "budget_ms";
constexpr const char* setting = "setting";
constexpr const char* error_rms = "error_rms";  ///< null if not measured

// volumes[]
constexpr const char* texture = "texture";
constexpr const char* size = "size";
constexpr const char* texture_format = "texture_format";
constexpr const char* draws = "draws";
constexpr const char* substituted = "substituted";
constexpr const char* left = "left";
constexpr const char* left_because = "left_because";  ///< {reason: count}
constexpr const char* explanation = "explanation";
constexpr const char* probes = "probes";
constexpr const char* texels = "texels";
constexpr const char* bytes_sent = "bytes_sent";
constexpr const char* bytes_left_out = "bytes_left_out";  ///< of changed textures: already on the nodes
constexpr const char* verify = "verify";
constexpr const char* worst_tile = "worst_tile";    ///< over whole images and sentinels; the bound is 1
constexpr const char* worst_frame = "worst_frame";  ///< the frame of the worst tile
constexpr const char* budget = "budget";            ///< null if no budget was requested
constexpr const char* asked = "asked";              ///< requested error; null if only a time was requested
constexpr const char* asked_ms = "asked_ms";
constexpr const char* measured = "measured";  ///< greatest error of the integrated rays
constexpr const char* rays_integrated = "rays_integrated";
constexpr const char* images_over = "images_over";
constexpr const char* calibrations = "calibrations";
constexpr const char* note = "note";        ///< why the budget is not kept
constexpr const char* exported = "export";  ///< null unless --export was given
constexpr const char* scene = "scene";      ///< file in the folder of --export; null if there is none
constexpr const char* max = "max";
constexpr const char* rms = "rms";
constexpr const char* psnr = "psnr";  ///< dB; null if nothing was verified or the images are equal

}  // namespace understudy::spu::report_key
