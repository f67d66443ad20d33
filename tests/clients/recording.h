// SPDX-License-Identifier: Apache-2.0
// apitrace's recording of the OpenGL calls that reach a driver, by frame, and the possible effect of each
// recorded draw on an image.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace clients {

struct RecordedFrame {
  std::vector<std::string> onto_window;     ///< draws that write pixels of the window's framebuffer
  std::vector<std::string> onto_own;        ///< draws that write pixels of a framebuffer object
  std::vector<std::string> depth_alone;     ///< draws with all colours masked
  std::vector<std::string> without_pixels;  ///< draws in feedback mode, or with rasterisation disabled
};

/// Parses the output of `apitrace dump`, up to the last end of a frame.
std::vector<RecordedFrame> frames_in(const std::string& dump);

/// Every call with its arguments, in order, as comparable text: without call numbers, with addresses masked,
/// and without look-ups of entry points, which have no effect.
std::vector<std::string> calls_in(const std::string& dump);

/// The names of the draws and their counts, for printing.
std::string summary(const std::vector<std::string>& draws);

}  // namespace clients
