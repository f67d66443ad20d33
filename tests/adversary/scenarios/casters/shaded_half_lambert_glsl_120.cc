// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shaded_half_lambert_glsl_120() {
  return {
      .sentence =
          "Half Lambert, squared, from the eye, GLSL 1.20 in immediate mode: 40 x 56 x 48 luminance bytes, "
          "a 1-D table whose opacities are corrected by pow(). A tooth with a translucent skin.",
      .expectation = Expectation::must_be_substituted,
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 120
varying vec3 vEntryTex;
varying vec3 vEntryObj;
varying vec3 vEyeObj;

void main(void)
{
    vEntryTex = gl_MultiTexCoord0.xyz;
    vEntryObj = gl_Vertex.xyz;
    vEyeObj = gl_ModelViewMatrixInverse[3].xyz;
    gl_Position = ftransform();
}
)",
                                  R"(#version 120
uniform sampler3D texVolume;        ///< the data volume
uniform sampler1D texTrans;         ///< the 1D transfer function
uniform vec3 vVoxelStepsize;        ///< size of one voxel in texture coordinates
uniform vec3 vDomainScale;
uniform float fRayStepsize;
uniform float fStepScale;           ///< opacity correction quotient

varying vec3 vEntryTex;
varying vec3 vEntryObj;
varying vec3 vEyeObj;

vec4 UnderCompositing(vec4 src, vec4 dst)
{
    vec4 result = dst;
    result.rgb += src.rgb * (1.0 - dst.a) * src.a;
    result.a += (1.0 - dst.a) * src.a;
    return result;
}

vec3 ComputeNormal(vec3 vCenter, vec3 vStepSize)
{
    float fVolumValXp = texture3D(texVolume, vCenter + vec3(+vStepSize.x, 0, 0)).x;
    float fVolumValXm = texture3D(texVolume, vCenter + vec3(-vStepSize.x, 0, 0)).x;
    float fVolumValYp = texture3D(texVolume, vCenter + vec3(0, +vStepSize.y, 0)).x;
    float fVolumValYm = texture3D(texVolume, vCenter + vec3(0, -vStepSize.y, 0)).x;
    float fVolumValZp = texture3D(texVolume, vCenter + vec3(0, 0, +vStepSize.z)).x;
    float fVolumValZm = texture3D(texVolume, vCenter + vec3(0, 0, -vStepSize.z)).x;
    vec3 vGradient = vec3(fVolumValXm - fVolumValXp,
                          fVolumValYm - fVolumValYp,
                          fVolumValZm - fVolumValZp);
    float l = length(vGradient);
    if (l > 0.0) vGradient /= l;    // safe normalization
    return vGradient;
}

vec3 Lighting(vec3 vColor, vec3 vNormal, vec3 vToViewer)
{
    float fWrapped = 0.5 + 0.5 * dot(vNormal, vToViewer);
    return vColor * (fWrapped * fWrapped);
}

void main(void)
{
    vec3 vRayDir = normalize(vEntryObj - vEyeObj);
    vec3 vRayInc = vRayDir * fRayStepsize / vDomainScale;
    vec3 vCurrentPos = vEntryTex;
    vec4 vColor = vec4(0.0, 0.0, 0.0, 0.0);

    for (int i = 0; i < 256; i++)
    {
        float fVolumVal = texture3D(texVolume, vCurrentPos).x;
        vec4 vTransVal = texture1D(texTrans, fVolumVal);
        vTransVal.a = 1.0 - pow(1.0 - vTransVal.a, fStepScale);

        vec3 vNormal = ComputeNormal(vCurrentPos, vVoxelStepsize);
        vTransVal.rgb = Lighting(vTransVal.rgb, vNormal, -vRayDir);
        vColor = UnderCompositing(vTransVal, vColor);

        vCurrentPos += vRayInc;
        if (any(lessThan(vCurrentPos, vec3(0.0))) || any(greaterThan(vCurrentPos, vec3(1.0))))
            break;
        if (vColor.a >= 0.99)
            break;
    }
    gl_FragColor = vColor;
}
)");
        const Field tooth = [](float x, float y, float z) {
          const float u = x - 0.5F, v = y - 0.48F, w = z - 0.52F;
          const float lobes =
              1.1F + 0.75F * y * u / (std::abs(u) + 0.1F) +
              0.9F * (1 - y) * std::cos(3 * std::atan2(w, u)) * std::min(1.0F, 40 * (u * u + w * w));
          const float radius = std::sqrt((u * u + w * w) / lobes + 0.6F * v * v);
          return std::clamp(1.05F - 1.95F * radius + 0.04F * std::sin(23 * y + 9 * x) * std::cos(14 * z), 0.0F,
                            1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float skin = std::exp(-std::pow((at - 0.25F) / 0.06F, 2.0F));
          const float core = std::clamp((at - 0.45F) / 0.08F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(250 - 20 * core),
                           static_cast<std::uint8_t>(120 + 110 * core), static_cast<std::uint8_t>(90 + 60 * at),
                           static_cast<std::uint8_t>(std::lround(12 * skin + 90 * core))});
        }
        upload_volume(canvas, 0, sampled(40, 56, 48, tooth), {.shown = Shown::luminance});
        upload_table_1d(canvas, 1, table);
        return [&canvas, program, corners = box_triangles()](int frame) {
          constexpr Vector extent{40 / 56.0F, 1, 48 / 56.0F};
          begin_old_frame(canvas,
                          old_camera(canvas, frame, {.azimuth = -35, .elevation = 24, .distance = 2.05F}));
          program.use();
          program.set("texVolume", 0);
          program.set("texTrans", 1);
          program.set("vVoxelStepsize", Vector{1 / 40.0F, 1 / 56.0F, 1 / 48.0F});
          program.set("vDomainScale", extent);
          program.set("fRayStepsize", 0.0125F);
          program.set("fStepScale", 0.8F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          canvas.gl.Begin(GL_TRIANGLES);
          for (const Vector& corner : corners) {
            canvas.gl.TexCoord3f(corner.x, corner.y, corner.z);
            canvas.gl.Vertex3f(0.5F + extent.x * (corner.x - 0.5F), 0.5F + extent.y * (corner.y - 0.5F),
                               0.5F + extent.z * (corner.z - 0.5F));
          }
          canvas.gl.End();
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
