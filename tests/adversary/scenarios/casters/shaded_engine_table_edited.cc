// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario shaded_engine_table_edited() {
  return {.sentence =
              "An engine block of 64 x 48 x 56 bytes, Blinn and Phong's light in structs of uniforms with the "
              "light's position set to the camera's, GLSL 3.30; the 1-D table of half floats is edited at "
              "frames 9 and 21.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {9, 21},
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 330
layout(location = 0) in vec3 vertex_;
uniform mat4 projectionViewMatrix_;
uniform vec3 volumeCubeSize_;
uniform vec3 volumeLlf_;
out vec3 entryTexture_;
out vec3 entryWorld_;
void main() {
    entryTexture_ = vertex_;
    entryWorld_ = volumeLlf_ + vertex_ * volumeCubeSize_;
    gl_Position = projectionViewMatrix_ * vec4(entryWorld_, 1.0);
}
)",
                                      R"(#version 330
#define RC_CALC_GRADIENTS(volume, p, pos) calcGradientCentralDifferences(volume, p, pos)
#define RC_APPLY_SHADING(g, pos, vp, ka, kd, ks) phongShading(g, pos, lightSource_, vp, ka, kd, ks)
#define SAMPLING_BASE_INTERVAL_RCP 60.0
#define EARLY_RAY_TERMINATION_OPACITY 0.99

struct VolumeParameters {
    vec3 datasetDimensions_;
    vec3 datasetDimensionsRCP_;
    vec3 datasetSpacing_;
    vec3 cubeSize_;
    vec3 llf_;
};

struct LightSource {
    vec3 position_;
    vec3 ambientColor_;
    vec3 diffuseColor_;
    vec3 specularColor_;
};

uniform sampler3D volume_;
uniform VolumeParameters volumeParameters_;
uniform sampler1D transferFunc_;
uniform LightSource lightSource_;
uniform vec3 cameraPosition_;
uniform float samplingStepSize_;
uniform float shininess_;

in vec3 entryTexture_;
in vec3 entryWorld_;
out vec4 FragData0;

vec4 getVoxel(sampler3D volume, VolumeParameters volumeParameters, vec3 samplePos) {
    return texture(volume, samplePos);
}

vec3 calcGradientCentralDifferences(sampler3D volume, VolumeParameters volumeParameters, vec3 samplePos) {
    vec3 offset = volumeParameters.datasetDimensionsRCP_;
    float v0 = getVoxel(volume, volumeParameters, samplePos + vec3(offset.x, 0.0, 0.0)).r;
    float v1 = getVoxel(volume, volumeParameters, samplePos + vec3(0.0, offset.y, 0.0)).r;
    float v2 = getVoxel(volume, volumeParameters, samplePos + vec3(0.0, 0.0, offset.z)).r;
    float v3 = getVoxel(volume, volumeParameters, samplePos + vec3(-offset.x, 0.0, 0.0)).r;
    float v4 = getVoxel(volume, volumeParameters, samplePos + vec3(0.0, -offset.y, 0.0)).r;
    float v5 = getVoxel(volume, volumeParameters, samplePos + vec3(0.0, 0.0, -offset.z)).r;
    vec3 gradient = vec3(v3 - v0, v4 - v1, v5 - v2);
    gradient /= volumeParameters.datasetSpacing_ * 2.0;
    return gradient;
}

vec3 getAmbientTerm(in vec3 ka, in vec3 ambientIntensity) { return ka * ambientIntensity; }

vec3 getDiffuseTerm(in vec3 kd, in vec3 diffuseIntensity, in vec3 N, in vec3 L) {
    float NdotL = max(dot(N, L), 0.0);
    return kd * diffuseIntensity * NdotL;
}

vec3 getSpecularTerm(in vec3 ks, in vec3 specularIntensity, in vec3 N, in vec3 L, in vec3 V, in float alpha) {
    vec3 H = normalize(V + L);
    float NdotH = pow(max(dot(N, H), 0.0), alpha);
    return ks * specularIntensity * NdotH;
}

vec3 phongShading(in vec3 gradient, in vec3 samplePos, in LightSource light, in vec3 viewPos,
                  in vec3 ka, in vec3 kd, in vec3 ks) {
    float len = length(gradient);
    vec3 N = len > 0.0 ? gradient / len : vec3(0.0);
    vec3 V = normalize(viewPos - samplePos);
    vec3 L = normalize(light.position_ - samplePos);

    vec3 shadedColor = vec3(0.0);
    shadedColor += getAmbientTerm(ka, light.ambientColor_);
    shadedColor += getDiffuseTerm(kd, light.diffuseColor_, N, L);
    shadedColor += getSpecularTerm(ks, light.specularColor_, N, L, V, shininess_);
    return shadedColor;
}

vec4 compositeDVR(in vec4 curResult, in vec4 color, in float t, inout float tDepth) {
    vec4 result = curResult;
    // apply opacity correction to accomodate for variable sampling intervals
    color.a = 1.0 - pow(1.0 - color.a, samplingStepSize_ * SAMPLING_BASE_INTERVAL_RCP);
    result.rgb = result.rgb + (1.0 - result.a) * color.a * color.rgb;
    result.a = result.a + (1.0 - result.a) * color.a;
    if (result.a > 0.0 && tDepth < 0.0)
        tDepth = t;
    return result;
}

void main() {
    vec3 rayDirection = normalize(entryWorld_ - cameraPosition_);
    vec3 rayTexture = rayDirection / volumeParameters_.cubeSize_;
    vec3 exits = (step(0.0, rayTexture) - entryTexture_) / rayTexture;
    float tEnd = min(min(exits.x, exits.y), exits.z);

    vec4 result = vec4(0.0);
    float t = 0.0;
    float tDepth = -1.0;
    bool finished = false;
    while (!finished) {
        vec3 samplePos = entryTexture_ + t * rayTexture;
        vec4 voxel = getVoxel(volume_, volumeParameters_, samplePos);
        vec4 color = texture(transferFunc_, voxel.r);
        if (color.a > 0.0) {
            voxel.xyz = RC_CALC_GRADIENTS(volume_, volumeParameters_, samplePos);
            color.rgb = RC_APPLY_SHADING(voxel.xyz, entryWorld_ + t * rayDirection, cameraPosition_,
                                         color.rgb, color.rgb, vec3(0.4));
            result = compositeDVR(result, color, t, tDepth);
        }
        if (result.a >= EARLY_RAY_TERMINATION_OPACITY) {
            result.a = 1.0;
            finished = true;
        }
        t += samplingStepSize_;
        finished = finished || (t > tEnd);
    }
    FragData0 = result;
}
)");
            const VertexBuffer vertices(canvas);
            const Field engine = [](float x, float y, float z) {
              const auto tube = [](float u, float v, float radius) {
                return 0.95F - 4.2F * std::abs(std::sqrt(u * u + v * v) - radius);
              };
              const float first = tube(x - 0.32F, z - 0.5F, 0.17F), second = tube(x - 0.7F, z - 0.46F, 0.14F);
              const float axle = 0.85F - 5 * std::sqrt(std::pow(y - 0.3F, 2.0F) + std::pow(z - 0.5F, 2.0F));
              const float plate = 0.55F - 4 * std::abs(y - 0.78F - 0.05F * std::sin(11 * x));
              const float ends = std::min(1.0F, 9 * std::min(y - 0.05F, 0.95F - y));
              return std::clamp(ends * std::max({first, second, axle, plate}), 0.0F, 1.0F);
            };
            upload_volume(canvas, 0, sampled(64, 48, 56, engine));
            const auto table_of = [](float centre, float red, float blue) {
              std::vector<float> table;
              for (int i = 0; i < 256; ++i) {
                const float at = static_cast<float>(i) / 255;
                const float shell = std::exp(-std::pow((at - centre) / 0.07F, 2.0F));
                const float solid = std::clamp((at - 0.7F) / 0.1F, 0.0F, 1.0F);
                table.insert(table.end(), {red + (0.9F - red) * at, 0.35F + 0.4F * at,
                                           blue * (1 - 0.5F * solid), 0.12F * shell + 0.5F * solid});
              }
              return table;
            };
            GLuint table = 0;
            canvas.gl.GenTextures(1, &table);
            canvas.gl.ActiveTexture(GL_TEXTURE1);
            canvas.gl.BindTexture(GL_TEXTURE_1D, table);
            filter_linearly(canvas, GL_TEXTURE_1D);
            canvas.gl.TexImage1D(GL_TEXTURE_1D, 0, GL_RGBA16F, 256, 0, GL_RGBA, GL_FLOAT,
                                 table_of(0.35F, 0.3F, 0.8F).data());
            return [&canvas, program, vertices, table_of](int frame) {
              if (frame == 9 || frame == 21) {
                const auto colours = frame == 9 ? table_of(0.5F, 0.8F, 0.3F) : table_of(0.25F, 0.5F, 0.9F);
                canvas.gl.ActiveTexture(GL_TEXTURE1);
                canvas.gl.TexSubImage1D(GL_TEXTURE_1D, 0, 0, 256, GL_RGBA, GL_FLOAT, colours.data());
              }
              constexpr Vector cube{1, 48 / 64.0F, 56 / 64.0F};
              const Vector llf = Vector{0.5F, 0.5F, 0.5F} - 0.5F * cube;
              const Orbit orbit{.azimuth = 50, .elevation = 30, .distance = 2.2F, .degrees_each_frame = 1};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.08F, 0.08F, 0.1F);
              program.use();
              program.set("projectionViewMatrix_", camera.clip_from_object());
              program.set("volumeCubeSize_", cube);
              program.set("volumeLlf_", llf);
              program.set("volume_", 0);
              program.set("transferFunc_", 1);
              program.set("volumeParameters_.datasetDimensions_", Vector{64, 48, 56});
              program.set("volumeParameters_.datasetDimensionsRCP_", Vector{1 / 64.0F, 1 / 48.0F, 1 / 56.0F});
              program.set("volumeParameters_.datasetSpacing_", Vector{0.5F, 0.5F, 0.5F});
              program.set("volumeParameters_.cubeSize_", cube);
              program.set("volumeParameters_.llf_", llf);
              program.set("lightSource_.position_", camera.eye);
              program.set("lightSource_.ambientColor_", Vector{0.25F, 0.25F, 0.25F});
              program.set("lightSource_.diffuseColor_", Vector{0.75F, 0.75F, 0.75F});
              program.set("lightSource_.specularColor_", Vector{0.6F, 0.6F, 0.6F});
              program.set("cameraPosition_", camera.eye);
              program.set("samplingStepSize_", 0.0125F);
              program.set("shininess_", 30.0F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
