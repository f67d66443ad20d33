// SPDX-License-Identifier: Apache-2.0
// Every option of Understudy, once: `understudy run` shows this table as its help and hands the values on as
// environment variables; a process started with plain LD_PRELOAD reads the same variables.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "spu/report/optimization.h"

namespace understudy::spu {

constexpr int max_nodes = 256;  ///< ranks of one node group

/// The options of one process. Values are checked when they are set (set_option()).
struct Options {
  int nodes = 0;  ///< 0: embedded
  std::string
      connect;         ///< Unix socket of a running `understudy serve`, or for launchers host:port; empty: none
  std::string report;  ///< JSON file; empty: none
  int verify = 0;      ///< every K frames; 0: when something changed that could make an image wrong; -1: never
  bool explain = false;
  OptimizationSet disabled_optimizations;
  bool disable = false;
  bool debug_tint = false;
  bool speed_guard = true;        ///< the viewer draws where that is faster; never with debug_tint
  double error = 0;               ///< that images may have; 0: samples are the viewer's own
  double time_ms = 0;             ///< that images may take; 0: samples are the viewer's own
  std::string save_frames;        ///< folder for PFM files; empty: none
  std::string exchange = "auto";  ///< name of compositor::set_algorithm
  std::string pixels = "float";   ///< name of compositor::set_layout
  std::string gather = "direct";  ///< name of compositor::set_gather
  std::string overlap = "auto";   ///< name of compositor::set_overlap
  bool tiles = false;             ///< the windows of a GL server are drawn by several processes
  int frame_latency = 0;          ///< frames that images of a moving camera may be behind
  std::string chain = "track volume driver";
  std::string run_dir;                 ///< the launcher's folder for this run (counters); empty: no launcher
  std::string server_opengl = "auto";  ///< what GL servers and replays draw with: auto, egl or osmesa
  bool sandbox = true;                 ///< processes of GL servers keep what drawing needs, and no more
  std::string remote;      ///< Unix socket of the GL server that makes the calls; empty: they are made here
  double verify_psnr = 0;  ///< dB; below this a compared image is refused

  bool has_budget() const { return error > 0 || time_ms > 0; }
};

/// How help and messages name an option.
struct OptionText {
  const char* flag;         ///< "--verify"; "-n,--nodes" where a short form exists; empty: environment only
  const char* environment;  ///< "UNDERSTUDY_VERIFY"
  const char* value;        ///< "K", "FILE"; "[K]" where the value may be left out; empty: a switch
  const char* fallback;     ///< the default, as text
  const char* help;
};

/// Every option, in the order of the help.
std::span<const OptionText> option_table();

/// Sets the option that `environment` names. False, with `options` unchanged, when there is no such option or
/// `text` is not a value it can take.
bool set_option(Options& options, std::string_view environment, const std::string& text);

/// Reads the variables of the table. A value that cannot be read is reported once on stderr and its default
/// taken.
Options options_from_environment();

}  // namespace understudy::spu
