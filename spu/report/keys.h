// SPDX-License-Identifier: Apache-2.0
// The names in the JSON report, once. They are a promise to whoever reads reports: keys are added, never
// renamed.
#pragma once

namespace understudy::spu::report_key {

// The run, summed over its processes.
constexpr const char* frames = "frames";
constexpr const char* frames_substituted = "frames_substituted";
constexpr const char* frames_left = "frames_left";
constexpr const char* nodes = "nodes";
constexpr const char* backends = "backends";  ///< of nodes of this run: who cast the rays, and why
constexpr const char* origin = "origin";      ///< of `understudy run`: version, command, machine, time
constexpr const char* remote = "remote";      ///< whether the viewer's whole stream was drawn elsewhere
constexpr const char* images_behind = "images_behind";  ///< --frame-latency: shown one frame late
constexpr const char* windows_asked = "windows_asked";  ///< how often a window was asked to draw again for that
constexpr const char* processes = "processes";
constexpr const char* time_ms = "time_ms";
constexpr const char* left_out = "left_out";  ///< {what: amount}
constexpr const char* frames_detail = "frames_detail";
constexpr const char* volumes = "volumes";

// server_connection: null unless remote. Of all processes of the run; per_frame are means.
constexpr const char* server_connection = "server_connection";
constexpr const char* round_trips = "round_trips";
constexpr const char* bytes_up = "bytes_up";
constexpr const char* bytes_down = "bytes_down";
constexpr const char* per_frame = "per_frame";
constexpr const char* lost =
    "lost";  ///< the GL server before the viewer; of verify: comparisons beyond the bound of a tile
constexpr const char* frames_lost = "frames_lost";  ///< ended, and never shown for that

// tiles: null unless --tiles on, on this machine.
constexpr const char* tiles = "tiles";
constexpr const char* of = "of";              ///< tiles of a window
constexpr const char* given_up = "given_up";  ///< why windows were drawn by one process from some frame on

// connection: null unless --connect HOST:PORT. Of all connections of the run: what went over TCP.
constexpr const char* connection = "connection";
constexpr const char* address = "address";
constexpr const char* connections = "connections";      ///< how many connections
constexpr const char* up = "up";                        ///< {messages, payload_bytes, bytes, blocks}
constexpr const char* down = "down";                    ///< {messages, payload_bytes, bytes}
constexpr const char* payload_bytes = "payload_bytes";  ///< before they were compressed
constexpr const char* blocks = "blocks";                ///< {none, lz4, zstd}: how they were compressed
constexpr const char* round_trip_ms = "round_trip_ms";  ///< as the kernel measures it
constexpr const char* bytes_per_second_up = "bytes_per_second_up";  ///< likewise

// processes[]
constexpr const char* pid = "pid";
constexpr const char* program = "program";
constexpr const char* calls = "calls";

// time_ms: medians over all frames, those with a substituted volume, and those whose volume the application
// drew.
constexpr const char* frame_median = "frame_median";
constexpr const char* substituted_median = "substituted_median";
constexpr const char* application_median = "application_median";
constexpr const char* waiting_median = "waiting_median";  ///< of substituted frames, as the next
constexpr const char* recognition_median = "recognition_median";
constexpr const char* depth_median = "depth_median";
constexpr const char* budget_median = "budget_median";

// left_out
constexpr const char* samples_skipped = "samples_skipped";
constexpr const char* rays_ended_early = "rays_ended_early";
constexpr const char* blocks_empty = "blocks_empty";
constexpr const char* nodes_idle = "nodes_idle";
constexpr const char* items =
    "items";  ///< {optimization: {unit, left_out, done, because}}; of a frame {optimization: left_out}
constexpr const char* unit = "unit";
constexpr const char* done = "done";
constexpr const char* because = "because";  ///< {reason: count}: why it was done

// exchanged: between nodes, for compositing
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
constexpr const char* error_rms = "error_rms";  ///< null where not measured

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
constexpr const char* bytes_left_out = "bytes_left_out";  ///< of changed textures: what the nodes had already
constexpr const char* verify = "verify";
constexpr const char* worst_tile = "worst_tile";    ///< of whole images and sentinels; 1 is the bound
constexpr const char* worst_frame = "worst_frame";  ///< the frame that it was in
constexpr const char* budget = "budget";            ///< null where none was asked for
constexpr const char* asked = "asked";              ///< error; null where only a time was
constexpr const char* asked_ms = "asked_ms";
constexpr const char* measured = "measured";  ///< greatest error of rays that were integrated
constexpr const char* rays_integrated = "rays_integrated";
constexpr const char* images_over = "images_over";
constexpr const char* calibrations = "calibrations";
constexpr const char* note = "note";  ///< why it is not kept
constexpr const char* max = "max";
constexpr const char* rms = "rms";
constexpr const char* psnr = "psnr";  ///< dB; null when nothing was verified or the images are equal

}  // namespace understudy::spu::report_key
