// SPDX-License-Identifier: Apache-2.0
#include "interceptor/remote/glx_config.h"

#include <GL/glx.h>

#include "interceptor/remote/config_attributes.h"

namespace understudy::interceptor {
namespace {

using enum Match;
using namespace config_value;

constexpr ConfigAttribute attributes[] = {
    {GLX_USE_GL, at_least, one},
    {GLX_RGBA, at_least, one},
    {GLX_X_RENDERABLE, disregarded, one},
    {GLX_FBCONFIG_ID, exact, id},
    {GLX_BUFFER_SIZE, at_least, buffer_bits},
    {GLX_RED_SIZE, at_least, colour_bits},
    {GLX_GREEN_SIZE, at_least, colour_bits},
    {GLX_BLUE_SIZE, at_least, colour_bits},
    {GLX_ALPHA_SIZE, at_least, alpha_bits},
    {GLX_DOUBLEBUFFER, exact, [](const RemoteConfig& config) { return config.double_buffered; }},
    {GLX_DEPTH_SIZE, at_least, depth_bits},
    {GLX_STENCIL_SIZE, at_least, stencil_bits},
    {GLX_SAMPLES, at_least, samples},
    {GLX_SAMPLE_BUFFERS, at_least, sample_buffers},
    {GLX_DRAWABLE_TYPE, all_bits,
     [](const RemoteConfig&) { return GLX_WINDOW_BIT | GLX_PBUFFER_BIT | GLX_PIXMAP_BIT; }},
    {GLX_RENDER_TYPE, all_bits, [](const RemoteConfig&) { return GLX_RGBA_BIT; }},
    {GLX_X_VISUAL_TYPE, exact, [](const RemoteConfig&) { return GLX_TRUE_COLOR; }},
    {GLX_CONFIG_CAVEAT, exact, [](const RemoteConfig&) { return GLX_NONE; }},
    {GLX_TRANSPARENT_TYPE, disregarded, [](const RemoteConfig&) { return GLX_NONE; }},
    {GLX_VISUAL_ID, disregarded, visual},
    {GLX_SCREEN, disregarded, [](const RemoteConfig& config) { return config.screen; }},
    {GLX_MAX_PBUFFER_WIDTH, disregarded, largest_side},
    {GLX_MAX_PBUFFER_HEIGHT, disregarded, largest_side},
    {GLX_MAX_PBUFFER_PIXELS, disregarded, largest_area},
    {GLX_LEVEL, exact, zero},
    {GLX_STEREO, exact, zero},
    {GLX_AUX_BUFFERS, at_least, zero},
    {GLX_ACCUM_RED_SIZE, at_least, zero},
    {GLX_ACCUM_GREEN_SIZE, at_least, zero},
    {GLX_ACCUM_BLUE_SIZE, at_least, zero},
    {GLX_ACCUM_ALPHA_SIZE, at_least, zero},
    {GLX_TRANSPARENT_INDEX_VALUE, at_least, zero},
    {GLX_TRANSPARENT_RED_VALUE, at_least, zero},
    {GLX_TRANSPARENT_GREEN_VALUE, at_least, zero},
    {GLX_TRANSPARENT_BLUE_VALUE, at_least, zero},
    {GLX_TRANSPARENT_ALPHA_VALUE, at_least, zero},
};

}  // namespace

int glx_attribute_of(const RemoteConfig& config, int attribute, int* value) {
  return attribute_of(attributes, config, attribute, value) ? Success : GLX_BAD_ATTRIBUTE;
}

bool meets_glx(const RemoteConfig& config, const int* list) {
  return meets_all(attributes, config, list, None, static_cast<int>(GLX_DONT_CARE));
}

}  // namespace understudy::interceptor
