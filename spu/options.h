// SPDX-License-Identifier: Apache-2.0
// The only table of Understudy's options: `understudy run` prints it as its help and passes the values on as
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
  int verify = 0;      ///< every K frames; 0: after changes that could make an image wrong; -1: never
  bool explain = false;
  OptimizationSet disabled_optimizations;
  bool disable = false;
  bool debug_tint = false;
  std::string control = "auto";   ///< whether `understudy ctl` may control the process: auto, on or off
  bool speed_guard = true;        ///< let the viewer draw if that is faster; never with debug_tint
  double error = 0;               ///< largest error of an image; 0: take the viewer's own samples
  double time_ms = 0;             ///< longest time for an image; 0: take the viewer's own samples
  std::string save_frames;        ///< folder for PFM files; empty: none
  std::string export_folder;      ///< for the scenes that were recognised; empty: none
  std::string exchange = "auto";  ///< name of compositor::set_algorithm
  std::string pixels = "float";   ///< name of compositor::set_layout
  std::string gather = "direct";  ///< name of compositor::set_gather
  std::string overlap = "auto";   ///< name of compositor::set_overlap
  bool tiles = false;             ///< draw the windows of a GL server with several processes
  int frame_latency = 0;          ///< frames by which images of a moving camera may be late
  std::string chain = "track volume driver";
  std::string run_dir;                 ///< the launcher's folder for this run (counters); empty: no launcher
  std::string server_opengl = "auto";  ///< OpenGL of GL servers and replays: auto, egl or osmesa
  bool sandbox = true;                 ///< restrict the processes of GL servers to what drawing needs
  std::string remote;                  ///< Unix socket of the GL server that makes the calls; empty: none
  double verify_psnr = 0;              ///< dB; a compared image below this is refused

  /// Under a launcher, viewers can be controlled unless that was switched off.
  bool can_be_controlled() const { return control == "on" || (control == "auto" && !run_dir.empty()); }
};

/// How help and messages present an option.
struct OptionText {
  const char* flag;         ///< "--verify"; "-n,--nodes" where a short form exists; empty: environment only
  const char* environment;  ///< "UNDERSTUDY_VERIFY"
  const char* value;        ///< "K", "FILE"; "[K]" if the value is optional; empty: a switch
  const char* fallback;     ///< the default, as text
  const char* help;
};

/// Every option, in the order of the help.
std::span<const OptionText> option_table();

/// Sets the option of the variable `environment`. Returns false and leaves `options` unchanged if there is no
/// such option or `text` is not a valid value of it.
bool set_option(Options& options, std::string_view environment, const std::string& text);

/// Reads the variables of the table. An invalid value is reported once on stderr and replaced by the default.
Options options_from_environment();

}  // namespace understudy::spu
