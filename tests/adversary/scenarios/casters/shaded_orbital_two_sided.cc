// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario shaded_orbital_two_sided() {
  return {.sentence =
              "A hydrogen orbital in 56 x 56 x 56 floats up to 4, normals turned to the viewer, ambient, "
              "diffuse and specular light, GLSL 3.30, a colour map in a 2-D texture.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 330 core
layout(location = 0) in vec3 a_position;
uniform mat4 u_transform;
out vec3 v_position;
void main() {
    v_position = a_position;
    gl_Position = u_transform * vec4(a_position, 1.0);
}
)",
                                      R"(#version 330 core
uniform sampler3D u_data;
uniform sampler2D u_cmdata;
uniform vec3 u_size;
uniform vec2 u_clim;
uniform vec3 u_camera;
uniform float u_relative_step_size;
in vec3 v_position;
layout(location = 0) out vec4 out_color;

const float ambient = 0.3;
const float diffuse = 0.6;
const float specular = 0.35;
const float shininess = 40.0;

float sample1(vec3 texcoords) {
    return texture(u_data, texcoords.xyz).r;
}

vec4 apply_colormap(float val) {
    val = (val - u_clim[0]) / (u_clim[1] - u_clim[0]);
    return texture(u_cmdata, vec2(val, 0.5));
}

vec4 add_lighting(vec4 color, vec3 loc, vec3 view_ray) {
    // Calculate color by incorporating lighting
    vec3 V = normalize(view_ray);
    vec3 step = 1.5 / u_size;

    // calculate normal vector from gradient
    vec3 N;
    float val1, val2;
    val1 = sample1(loc + vec3(-step[0], 0.0, 0.0));
    val2 = sample1(loc + vec3(+step[0], 0.0, 0.0));
    N[0] = val1 - val2;
    val1 = sample1(loc + vec3(0.0, -step[1], 0.0));
    val2 = sample1(loc + vec3(0.0, +step[1], 0.0));
    N[1] = val1 - val2;
    val1 = sample1(loc + vec3(0.0, 0.0, -step[2]));
    val2 = sample1(loc + vec3(0.0, 0.0, +step[2]));
    N[2] = val1 - val2;

    float gm = length(N);
    N = N / max(gm, 1e-12);

    // Flip normal so it points towards viewer
    float Nselect = float(dot(N, V) > 0.0);
    N = (2.0 * Nselect - 1.0) * N;

    // only one light, at the camera
    vec3 L = V;
    float lambertTerm = clamp(dot(N, L), 0.0, 1.0);
    vec3 H = normalize(L + V);
    float specularTerm = pow(max(dot(H, N), 0.0), shininess);
    return vec4(color.rgb * (ambient + diffuse * lambertTerm) + specular * specularTerm, color.a);
}

void main() {
    vec3 view_ray = normalize(v_position - u_camera);
    vec3 t = max((vec3(0.0) - v_position) / view_ray, (vec3(1.0) - v_position) / view_ray);
    int nsteps = int(min(t.x, min(t.y, t.z)) / u_relative_step_size + 0.5);
    vec3 step = view_ray * u_relative_step_size;
    vec3 loc = v_position;
    vec4 integrated_color = vec4(0.0);
    for (int iter = 0; iter < nsteps; iter++) {
        float val = sample1(loc);
        vec4 color = add_lighting(apply_colormap(val), loc, -view_ray);
        float a1 = integrated_color.a;
        float a2 = color.a * (1.0 - a1);
        integrated_color.rgb += color.rgb * a2;
        integrated_color.a = a1 + a2;
        if (integrated_color.a > 0.99)
            break;
        loc += step;
    }
    out_color = integrated_color;
}
)");
            const VertexBuffer vertices(canvas);
            const Field orbital = [](float x, float y, float z) {
              const float u = x - 0.5F, v = y - 0.5F, w = z - 0.5F;
              const float square = u * u + v * v + w * w + 1e-9F;
              const float radius = std::sqrt(square) / 0.062F;
              const float angular = 3 * (0.3F * u + 0.95F * v) * (0.3F * u + 0.95F * v) / square - 1;
              return angular * angular * std::pow(radius / 4, 4.0F) * std::exp(4 - radius);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float shell = std::exp(-std::pow((at - 0.12F) / 0.05F, 2.0F));
              table.push_back({static_cast<std::uint8_t>(70 + 170 * at),
                               static_cast<std::uint8_t>(150 - 120 * at * at),
                               static_cast<std::uint8_t>(230 - 190 * at),
                               static_cast<std::uint8_t>(std::lround(40 * shell + 80 * at * at))});
            }
            upload_volume(canvas, 0, sampled(56, orbital), {.texel = Texel::float32});
            upload_table_2d(canvas, 1, table);
            return [&canvas, program, vertices](int frame) {
              const Orbit orbit{.azimuth = 75, .elevation = 25, .distance = 2.2F, .degrees_each_frame = 1.5F};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0, 0, 0);
              program.use();
              program.set("u_transform", camera.clip_from_object());
              program.set("u_camera", camera.eye);
              program.set("u_size", Vector{56, 56, 56});
              program.set("u_data", 0);
              program.set("u_cmdata", 1);
              program.set("u_relative_step_size", 0.015F);
              canvas.gl.Uniform2f(program.location("u_clim"), 0, 2.2F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
