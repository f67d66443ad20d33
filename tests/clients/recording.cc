// SPDX-License-Identifier: Apache-2.0
#include "tests/clients/recording.h"

#include <fmt/format.h>

#include <map>
#include <regex>
#include <sstream>
#include <string_view>
#include <utility>

namespace clients {
namespace {

bool is_draw(const std::string& call) {
  static const std::regex draws(
      "glBegin|glRect.*|glDrawArrays.*|glDrawElements.*|glDrawRangeElements.*|glMultiDraw.*|"
      "glDrawTransformFeedback.*|"
      "glCallLists?|glBlitFramebuffer|glDrawPixels|glBitmap|glCopyPixels|glEvalMesh.");
  return std::regex_match(call, draws);
}

bool has(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

std::vector<RecordedFrame> frames_in(const std::string& dump) {
  // "1234 glName(name = value, ...) = result"; some calls span several lines.
  static const std::regex start("^[0-9]+ ([A-Za-z0-9]+)\\((.*)$");
  std::vector<RecordedFrame> frames;
  RecordedFrame frame;
  bool compiling = false, feedback = false, discarding = false, own_framebuffer = false, masked = false;
  std::istringstream stream(dump);
  for (std::string line; std::getline(stream, line);) {
    std::smatch match;
    // Regular expressions need too much stack for long lines (texels, buffers).
    const std::string head = line.substr(0, 400);
    if (!std::regex_match(head, match, start)) continue;
    const std::string call = match[1], arguments = match[2];
    if (call == "glNewList") compiling = !has(arguments, "GL_COMPILE_AND_EXECUTE");
    if (call == "glEndList") compiling = false;
    if (call == "glRenderMode") feedback = !has(arguments, "mode = GL_RENDER");
    if (has(arguments, "cap = GL_RASTERIZER_DISCARD")) discarding = call == "glEnable";
    if (call == "glBindFramebuffer" && !has(arguments, "GL_READ_FRAMEBUFFER"))
      own_framebuffer = !has(arguments, "framebuffer = 0)");
    if (call == "glColorMask") masked = !has(arguments, "GL_TRUE");
    if (is_draw(call) && !compiling) {
      auto& kind = feedback || discarding ? frame.without_pixels
                   : masked               ? frame.depth_alone
                   : own_framebuffer      ? frame.onto_own
                                          : frame.onto_window;
      kind.push_back(fmt::format("{}({}", call, arguments));
    }
    if (call.ends_with("SwapBuffers")) frames.push_back(std::exchange(frame, {}));
  }
  return frames;
}

std::vector<std::string> calls_in(const std::string& dump) {
  std::vector<std::string> calls;
  std::istringstream stream(dump);
  for (std::string line; std::getline(stream, line);) {
    const std::size_t digits = line.find_first_not_of("0123456789");
    const bool first_line = digits != 0 && digits != std::string::npos && line[digits] == ' ';
    if (first_line) line.erase(0, digits + 1);
    if (first_line && has(line.substr(0, line.find('(')), "GetProcAddress")) continue;
    for (std::size_t at = line.find("0x"); at != std::string::npos; at = line.find("0x", at + 2)) {
      const std::size_t end = line.find_first_not_of("0123456789abcdef", at + 2);
      line.erase(at + 2, end == std::string::npos ? end : end - at - 2);
    }
    if (has(line, "pname = GL_TIMESTAMP")) line.erase(line.find("params"));
    if (!line.empty()) calls.push_back(std::move(line));
  }
  return calls;
}

std::string summary(const std::vector<std::string>& draws) {
  std::map<std::string, int> counts;
  for (const std::string& draw : draws) ++counts[draw.substr(0, draw.find('('))];
  std::string text;
  for (const auto& [draw, count] : counts)
    text += fmt::format("{}{} × {}", text.empty() ? "" : ", ", count, draw);
  return text.empty() ? "nothing" : text;
}

}  // namespace clients
