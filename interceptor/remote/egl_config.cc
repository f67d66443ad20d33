// SPDX-License-Identifier: Apache-2.0
#include "interceptor/remote/egl_config.h"

#include <EGL/egl.h>
#include <X11/Xlib.h>

#include "interceptor/remote/config_attributes.h"

namespace understudy::interceptor {
namespace {

using enum Match;
using namespace config_value;

constexpr ConfigAttribute attributes[] = {
    {EGL_BUFFER_SIZE, at_least, buffer_bits},
    {EGL_RED_SIZE, at_least, colour_bits},
    {EGL_GREEN_SIZE, at_least, colour_bits},
    {EGL_BLUE_SIZE, at_least, colour_bits},
    {EGL_ALPHA_SIZE, at_least, alpha_bits},
    {EGL_DEPTH_SIZE, at_least, depth_bits},
    {EGL_STENCIL_SIZE, at_least, stencil_bits},
    {EGL_SAMPLES, at_least, samples},
    {EGL_SAMPLE_BUFFERS, at_least, sample_buffers},
    {EGL_CONFIG_ID, exact, id},
    {EGL_SURFACE_TYPE, all_bits,
     [](const RemoteConfig& config) {
       return config.visual != 0 ? EGL_WINDOW_BIT | EGL_PBUFFER_BIT : EGL_PBUFFER_BIT;
     }},
    {EGL_RENDERABLE_TYPE, all_bits, [](const RemoteConfig&) { return EGL_OPENGL_BIT; }},
    {EGL_CONFORMANT, all_bits, [](const RemoteConfig&) { return EGL_OPENGL_BIT; }},
    {EGL_NATIVE_VISUAL_ID, disregarded, visual},
    {EGL_NATIVE_VISUAL_TYPE, exact,
     [](const RemoteConfig& config) { return config.visual != 0 ? TrueColor : EGL_NONE; }},
    {EGL_COLOR_BUFFER_TYPE, exact, [](const RemoteConfig&) { return EGL_RGB_BUFFER; }},
    {EGL_CONFIG_CAVEAT, exact, [](const RemoteConfig&) { return EGL_NONE; }},
    {EGL_TRANSPARENT_TYPE, exact, [](const RemoteConfig&) { return EGL_NONE; }},
    {EGL_MAX_PBUFFER_WIDTH, disregarded, largest_side},
    {EGL_MAX_PBUFFER_HEIGHT, disregarded, largest_side},
    {EGL_MAX_PBUFFER_PIXELS, disregarded, largest_area},
    {EGL_MAX_SWAP_INTERVAL, at_least, one},
    {EGL_MIN_SWAP_INTERVAL, at_least, zero},
    {EGL_LEVEL, exact, zero},
    {EGL_LUMINANCE_SIZE, at_least, zero},
    {EGL_ALPHA_MASK_SIZE, at_least, zero},
    {EGL_BIND_TO_TEXTURE_RGB, at_least, zero},
    {EGL_BIND_TO_TEXTURE_RGBA, at_least, zero},
    {EGL_NATIVE_RENDERABLE, disregarded, zero},
    {EGL_TRANSPARENT_RED_VALUE, at_least, zero},
    {EGL_TRANSPARENT_GREEN_VALUE, at_least, zero},
    {EGL_TRANSPARENT_BLUE_VALUE, at_least, zero},
};

}  // namespace

bool egl_attribute_of(const RemoteConfig& config, int attribute, int* value) {
  return attribute_of(attributes, config, attribute, value);
}

bool meets_egl(const RemoteConfig& config, const int* list) {
  return meets_all(attributes, config, list, EGL_NONE, EGL_DONT_CARE);
}

}  // namespace understudy::interceptor
