// SPDX-License-Identifier: Apache-2.0
#include "slice_scenes.h"

#include <array>
#include <cmath>
#include <memory>

#include "glsl_program.h"

namespace understudy::spu::testing {
namespace {

constexpr int slices = 40;

double slice_z(int i) {
  return (i + 0.5) / slices;
}

void filter(const DispatchTable& gl, GLenum target, GLenum mode) {
  gl.TexParameteri(target, GL_TEXTURE_MIN_FILTER, GLint(mode));
  gl.TexParameteri(target, GL_TEXTURE_MAG_FILTER, GLint(mode));
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) {
    gl.TexParameteri(target, axis, GL_CLAMP_TO_EDGE);
  }
}

void scalar_texture(const DispatchTable& gl, GLenum internal_format, GLenum format) {
  const Blob blob;
  GLuint texture = 0;
  gl.GenTextures(1, &texture);
  gl.BindTexture(GL_TEXTURE_3D, texture);
  filter(gl, GL_TEXTURE_3D, GL_LINEAR);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl.TexImage3D(GL_TEXTURE_3D, 0, GLint(internal_format), blob.x, blob.y, blob.z, 0, format, GL_UNSIGNED_BYTE,
                blob.texels().data());
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 4);
}

void table_texture(const DispatchTable& gl) {
  std::vector<float> table;
  for (int i = 0; i < 256; ++i) {
    const float s = float(i) / 255;
    table.insert(table.end(), {s, 0.5F + 0.5F * std::sin(9 * s), 1 - s, 0.2F * s * s});
  }
  GLuint texture = 0;
  gl.GenTextures(1, &texture);
  gl.ActiveTexture(GL_TEXTURE1);
  gl.BindTexture(GL_TEXTURE_1D, texture);
  filter(gl, GL_TEXTURE_1D, GL_LINEAR);
  gl.TexImage1D(GL_TEXTURE_1D, 0, GL_RGBA32F, 256, 0, GL_RGBA, GL_FLOAT, table.data());
  gl.ActiveTexture(GL_TEXTURE0);
}

void fixed_function_camera(const DispatchTable& gl, double angle) {
  gl.MatrixMode(GL_PROJECTION);
  gl.LoadIdentity();
  gl.Frustum(-0.3, 0.3, -0.3, 0.3, 1, 10);
  gl.MatrixMode(GL_MODELVIEW);
  gl.LoadIdentity();
  gl.Translated(0, 0, -3);
  gl.Rotated(angle, 0.2, 1, 0.1);
  gl.Translated(-0.5, -0.5, -0.5);
}

void blend_over(const DispatchTable& gl) {
  gl.Enable(GL_BLEND);
  gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
}

using Matrix = std::array<float, 16>;  // column-major, as OpenGL expects

Matrix camera_matrix(double angle) {
  const double c = std::cos(angle * M_PI / 180);
  const double s = std::sin(angle * M_PI / 180);
  const double f = 3.3;
  const double near = 1;
  const double far = 10;
  const double zz = (far + near) / (near - far);
  const double zt = 2 * far * near / (near - far);
  // projection * translate(0, 0, -3) * rotate_y(angle) * translate(-1/2)
  const auto column = [&](double x, double y, double z, double w) {
    const double ex = c * x + s * z;
    const double ey = y;
    const double ez = -s * x + c * z - 3 * w;
    return std::array<float, 4>{float(f * ex), float(f * ey), float(zz * ez + zt * w), float(-ez)};
  };
  Matrix m{};
  const std::array<std::array<float, 4>, 4> columns = {column(1, 0, 0, 0), column(0, 1, 0, 0),
                                                       column(0, 0, 1, 0), column(-0.5, -0.5, -0.5, 1)};
  for (std::size_t i = 0; i < 16; ++i) m[i] = columns[i / 4][i % 4];
  return m;
}

GLuint program(const DispatchTable& gl, const char* vertex, const char* fragment) {
  return glsl_program(gl, vertex, fragment, 3);
}

void quad_corners(double z, std::array<GLfloat, 12>& corners) {
  const auto w = GLfloat(z);
  corners = {0, 0, w, 1, 0, w, 1, 1, w, 0, 1, w};
}

}  // namespace

void SliceScene::slices_and_tidy_up(GlApplication& app, double angle) const {
  slices(app, angle);
  tidy_up(app);
}

void SliceScene::draw(GlApplication& app, double angle) const {
  draw_to_the_last_slice(app, angle);
  tidy_up(app);
}

void SliceScene::draw_to_the_last_slice(GlApplication& app, double angle) const {
  app.gl().Viewport(0, 0, GlApplication::size, GlApplication::size);
  app.gl().ClearColor(0.1F, 0.2F, 0.3F, 0.0F);
  app.gl().Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  slices(app, angle);
}

SliceBlending usual_blending() {
  return {[](const DispatchTable& gl) { gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA); }};
}

SliceScene immediate_rgba() {
  return immediate_rgba(usual_blending());
}

SliceScene immediate_rgba(const SliceBlending& blending) {
  SliceScene scene{"glBegin/glEnd quads, fixed function, RGBA8 voxels"};
  scene.set_up = [](GlApplication& app) {
    const Blob blob;
    std::vector<std::uint8_t> colours;
    for (const std::uint8_t s : blob.texels()) {
      colours.insert(colours.end(), {s, std::uint8_t(255 - s), 90, std::uint8_t(s * s / 255 / 5)});
    }
    GLuint texture = 0;
    app.gl().GenTextures(1, &texture);
    app.gl().BindTexture(GL_TEXTURE_3D, texture);
    filter(app.gl(), GL_TEXTURE_3D, GL_LINEAR);
    app.gl().TexImage3D(GL_TEXTURE_3D, 0, GL_RGBA8, blob.x, blob.y, blob.z, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                        colours.data());
  };
  scene.slices = [blending](GlApplication& app, double angle) {
    fixed_function_camera(app.gl(), angle);
    app.gl().Enable(GL_BLEND);
    blending.set(app.gl());
    app.gl().Enable(GL_TEXTURE_3D);
    app.gl().TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_MODULATE);
    app.gl().Color4f(1, 0.8F, 0.9F, 1);
    for (int i = 0; i < slices; ++i) {
      const double z = slice_z(blending.front_to_back ? slices - 1 - i : i);
      app.gl().Begin(GL_QUADS);
      for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
        app.gl().TexCoord3d(x, y, z);
        app.gl().Vertex3d(x, y, z);
      }
      app.gl().End();
    }
  };
  scene.tidy_up = [](GlApplication& app) {
    app.gl().Disable(GL_TEXTURE_3D);
    app.gl().Disable(GL_BLEND);
  };
  return scene;
}

SliceScene display_list_texgen() {
  SliceScene scene{
      "display list, eye-linear texgen, clip planes, lighting, alpha test, padded INTENSITY texture"};
  auto list = std::make_shared<GLuint>(0);
  scene.set_up = [list](GlApplication& app) {
    const Blob blob;
    const auto texels = blob.texels();
    std::vector<std::uint8_t> padded(32 * 32 * 32, 0);
    for (int k = 0; k < blob.z; ++k) {
      for (int j = 0; j < blob.y; ++j) {
        for (int i = 0; i < blob.x; ++i) {
          const int to = (k * 32 + j) * 32 + i;
          const int from = (k * blob.y + j) * blob.x + i;
          padded[std::size_t(to)] = texels[std::size_t(from)];
        }
      }
    }
    GLuint texture = 0;
    app.gl().GenTextures(1, &texture);
    app.gl().BindTexture(GL_TEXTURE_3D, texture);
    filter(app.gl(), GL_TEXTURE_3D, GL_LINEAR);
    app.gl().TexImage3D(GL_TEXTURE_3D, 0, GL_INTENSITY, 32, 32, 32, 0, GL_LUMINANCE, GL_UNSIGNED_BYTE,
                        padded.data());
    *list = app.gl().GenLists(1);
    app.gl().NewList(*list, GL_COMPILE);
    app.gl().Normal3f(0, 0, 1);
    app.gl().Begin(GL_QUADS);
    for (int i = 0; i < slices; ++i) {
      const double z = -0.9 + 1.8 * slice_z(i);
      for (const auto& [x, y] : {std::pair{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) {
        app.gl().Vertex3d(x, y, z);
      }
    }
    app.gl().End();
    app.gl().EndList();
  };
  scene.slices = [list](GlApplication& app, double angle) {
    const Blob blob;
    fixed_function_camera(app.gl(), angle);
    const std::array<double, 3> used = {blob.x / 32.0, blob.y / 32.0, blob.z / 32.0};
    constexpr std::array<GLenum, 3> coordinates = {GL_S, GL_T, GL_R};
    constexpr std::array<GLenum, 3> generators = {GL_TEXTURE_GEN_S, GL_TEXTURE_GEN_T, GL_TEXTURE_GEN_R};
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<GLdouble, 4> plane{};
      plane[k] = used[k];
      app.gl().TexGeni(coordinates[k], GL_TEXTURE_GEN_MODE, GL_EYE_LINEAR);
      app.gl().TexGendv(coordinates[k], GL_EYE_PLANE, plane.data());
      app.gl().Enable(generators[k]);
      for (const int side : {0, 1}) {
        std::array<GLdouble, 4> cut{};
        cut[k] = side == 0 ? 1 : -1;
        cut[3] = side == 0 ? 0 : 1;
        app.gl().ClipPlane(GLenum(GL_CLIP_PLANE0 + 2 * int(k) + side), cut.data());
        app.gl().Enable(GLenum(GL_CLIP_PLANE0 + 2 * int(k) + side));
      }
    }
    // Billboard: the slices face the eye, whatever the volume's rotation was when texgen was set.
    app.gl().LoadIdentity();
    app.gl().Translated(0, 0, -3);
    blend_over(app.gl());
    app.gl().Enable(GL_ALPHA_TEST);
    app.gl().AlphaFunc(GL_GREATER, 0.02F);
    app.gl().Enable(GL_LIGHTING);
    app.gl().Enable(GL_LIGHT0);
    app.gl().Enable(GL_TEXTURE_3D);
    app.gl().TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_MODULATE);
    app.gl().CallList(*list);
  };
  scene.tidy_up = [](GlApplication& app) {
    for (const GLenum off : {GL_TEXTURE_3D, GL_LIGHTING, GL_ALPHA_TEST, GL_BLEND, GL_TEXTURE_GEN_S,
                             GL_TEXTURE_GEN_T, GL_TEXTURE_GEN_R})
      app.gl().Disable(off);
    for (int i = 0; i < 6; ++i) app.gl().Disable(GLenum(GL_CLIP_PLANE0 + i));
  };
  return scene;
}

SliceScene client_arrays_table() {
  return client_arrays_table(usual_blending());
}

SliceScene client_arrays_table(const SliceBlending& blending) {
  SliceScene scene{"one client array refilled for every slice, GLSL 1.20 fragments with a 1-D table"};
  auto name = std::make_shared<GLuint>(0);
  scene.set_up = [name](GlApplication& app) {
    scalar_texture(app.gl(), GL_LUMINANCE8, GL_LUMINANCE);
    table_texture(app.gl());
    *name =
        program(app.gl(), nullptr,
                "#version 120\n"
                "uniform sampler3D field; uniform sampler1D table;\n"
                "void main() { gl_FragColor = texture1D(table, texture3D(field, gl_TexCoord[0].xyz).r); }\n");
    app.gl().UseProgram(*name);
    app.gl().Uniform1i(app.gl().GetUniformLocation(*name, "field"), 0);
    app.gl().Uniform1i(app.gl().GetUniformLocation(*name, "table"), 1);
    app.gl().UseProgram(0);
  };
  auto array = std::make_shared<std::array<GLfloat, 12>>();
  scene.slices = [name, array, blending](GlApplication& app, double angle) {
    fixed_function_camera(app.gl(), angle);
    app.gl().Enable(GL_BLEND);
    blending.set(app.gl());
    app.gl().UseProgram(*name);
    std::array<GLfloat, 12>& corners = *array;
    app.gl().EnableClientState(GL_VERTEX_ARRAY);
    app.gl().EnableClientState(GL_TEXTURE_COORD_ARRAY);
    app.gl().VertexPointer(3, GL_FLOAT, 0, corners.data());
    app.gl().TexCoordPointer(3, GL_FLOAT, 0, corners.data());
    for (int i = 0; i < slices; ++i) {
      quad_corners(slice_z(blending.front_to_back ? slices - 1 - i : i), corners);
      app.gl().DrawArrays(GL_TRIANGLE_FAN, 0, 4);
    }
  };
  scene.tidy_up = [](GlApplication& app) {
    app.gl().DisableClientState(GL_VERTEX_ARRAY);
    app.gl().DisableClientState(GL_TEXTURE_COORD_ARRAY);
    app.gl().UseProgram(0);
    app.gl().Disable(GL_BLEND);
  };
  return scene;
}

SliceScene vertex_shader_varying() {
  SliceScene scene{"GLSL 1.20 with a varying of its own and a generic attribute"};
  auto name = std::make_shared<GLuint>(0);
  scene.set_up = [name](GlApplication& app) {
    scalar_texture(app.gl(), GL_R8, GL_RED);
    table_texture(app.gl());
    *name =
        program(app.gl(),
                "#version 120\n"
                "uniform mat4 camera; attribute vec3 corner; varying vec3 place; varying float gain;\n"
                "void main() { place = corner; gain = 0.75; gl_Position = camera * vec4(corner, 1.0); }\n",
                "#version 120\n"
                "uniform sampler3D field; uniform sampler1D table; varying vec3 place; varying float gain;\n"
                "void main() { gl_FragColor = gain * texture1D(table, texture3D(field, place).r); }\n");
    app.gl().UseProgram(*name);
    app.gl().Uniform1i(app.gl().GetUniformLocation(*name, "field"), 0);
    app.gl().Uniform1i(app.gl().GetUniformLocation(*name, "table"), 1);
    app.gl().UseProgram(0);
  };
  auto array = std::make_shared<std::vector<std::array<GLfloat, 12>>>(slices);
  scene.slices = [name, array](GlApplication& app, double angle) {
    blend_over(app.gl());
    app.gl().UseProgram(*name);
    const Matrix camera = camera_matrix(angle);
    app.gl().UniformMatrix4fv(app.gl().GetUniformLocation(*name, "camera"), 1, GL_FALSE, camera.data());
    std::vector<std::array<GLfloat, 12>>& quads = *array;
    for (int i = 0; i < slices; ++i) quad_corners(slice_z(i), quads[std::size_t(i)]);
    app.gl().EnableVertexAttribArray(3);
    app.gl().VertexAttribPointer(3, 3, GL_FLOAT, GL_FALSE, 0, quads.data());
    app.gl().DrawArrays(GL_QUADS, 0, 4 * slices);
  };
  scene.tidy_up = [](GlApplication& app) {
    app.gl().DisableVertexAttribArray(3);
    app.gl().UseProgram(0);
    app.gl().Disable(GL_BLEND);
  };
  return scene;
}

SliceScene texture_stack() {
  SliceScene scene{"a stack of 2-D textures, one quad each"};
  auto stack = std::make_shared<std::vector<GLuint>>();
  scene.set_up = [stack](GlApplication& app) {
    const Blob blob;
    const auto texels = blob.texels();
    stack->resize(std::size_t(blob.z));
    app.gl().GenTextures(blob.z, stack->data());
    for (int z = 0; z < blob.z; ++z) {
      std::vector<std::uint8_t> colours;
      for (int i = 0; i < blob.x * blob.y; ++i) {
        const int at = z * blob.x * blob.y + i;
        const std::uint8_t s = texels[std::size_t(at)];
        colours.insert(colours.end(), {s, std::uint8_t(255 - s), 90, std::uint8_t(s * s / 255 / 3)});
      }
      app.gl().BindTexture(GL_TEXTURE_2D, (*stack)[std::size_t(z)]);
      filter(app.gl(), GL_TEXTURE_2D, GL_LINEAR);
      app.gl().TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, blob.x, blob.y, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                          colours.data());
    }
  };
  scene.slices = [stack](GlApplication& app, double angle) {
    fixed_function_camera(app.gl(), angle);
    blend_over(app.gl());
    app.gl().Enable(GL_TEXTURE_2D);
    app.gl().TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_MODULATE);
    app.gl().Color4f(1, 0.8F, 0.9F, 1);
    const std::size_t n = stack->size();
    const bool from_behind = std::cos(angle * M_PI / 180) < 0;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t slice = from_behind ? n - 1 - i : i;
      app.gl().BindTexture(GL_TEXTURE_2D, (*stack)[slice]);
      app.gl().Begin(GL_QUADS);
      for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
        app.gl().TexCoord2d(x, y);
        app.gl().Vertex3d(x, y, (double(slice) + 0.5) / double(n));
      }
      app.gl().End();
    }
  };
  scene.tidy_up = [](GlApplication& app) {
    app.gl().Disable(GL_TEXTURE_2D);
    app.gl().Disable(GL_BLEND);
  };
  return scene;
}

SliceScene assembly_program(bool two_dimensional_table) {
  SliceScene scene{two_dimensional_table ? "ARB vertex and fragment programs with a 2-D table"
                                         : "ARB fragment program with a 1-D table"};
  auto names = std::make_shared<std::array<GLuint, 2>>();
  const auto load = [](const DispatchTable& gl, GLenum target, GLuint name, const std::string& text) {
    gl.BindProgramARB(target, name);
    gl.ProgramStringARB(target, GL_PROGRAM_FORMAT_ASCII_ARB, GLsizei(text.size()), text.data());
  };
  scene.set_up = [names, load, two_dimensional_table](GlApplication& app) {
    const DispatchTable& gl = app.gl();
    scalar_texture(gl, GL_LUMINANCE8, GL_LUMINANCE);
    gl.GenProgramsARB(2, names->data());
    if (!two_dimensional_table) {
      table_texture(gl);
      load(gl, GL_FRAGMENT_PROGRAM_ARB, (*names)[0],
           "!!ARBfp1.0\n"
           "TEMP field;\n"
           "TEX field, fragment.texcoord[0], texture[0], 3D;\n"
           "TEX result.color, field, texture[1], 1D;\n"
           "END\n");
      return;
    }
    std::vector<float> table;
    for (int row = 0; row < 4; ++row) {
      for (int i = 0; i < 64; ++i) {
        const float s = float(i) / 63;
        table.insert(table.end(), {s, row == 2 ? 1 - s : 0.0F, 0.5F, 0.2F * s * s});
      }
    }
    GLuint texture = 0;
    gl.GenTextures(1, &texture);
    gl.ActiveTexture(GL_TEXTURE1);
    gl.BindTexture(GL_TEXTURE_2D, texture);
    filter(gl, GL_TEXTURE_2D, GL_LINEAR);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 64, 4, 0, GL_RGBA, GL_FLOAT, table.data());
    gl.ActiveTexture(GL_TEXTURE0);
    load(gl, GL_FRAGMENT_PROGRAM_ARB, (*names)[0],
         "!!ARBfp1.0\n"
         "TEMP field, colour;\n"
         "TEX field, fragment.texcoord[0], texture[0], 3D;\n"
         "MOV field.y, 0.625;\n"
         "TEX colour, field, texture[1], 2D;\n"
         "MUL result.color, colour, program.local[0];\n"
         "END\n");
    gl.ProgramLocalParameter4fARB(GL_FRAGMENT_PROGRAM_ARB, 0, 1, 0.75F, 1, 0.8F);
    load(gl, GL_VERTEX_PROGRAM_ARB, (*names)[1],
         "!!ARBvp1.0\n"
         "OPTION ARB_position_invariant;\n"
         "MOV result.texcoord[0], vertex.texcoord[0];\n"
         "END\n");
  };
  scene.slices = [names, two_dimensional_table](GlApplication& app, double angle) {
    fixed_function_camera(app.gl(), angle);
    blend_over(app.gl());
    app.gl().Enable(GL_FRAGMENT_PROGRAM_ARB);
    app.gl().BindProgramARB(GL_FRAGMENT_PROGRAM_ARB, (*names)[0]);
    if (two_dimensional_table) {
      app.gl().Enable(GL_VERTEX_PROGRAM_ARB);
      app.gl().BindProgramARB(GL_VERTEX_PROGRAM_ARB, (*names)[1]);
    }
    app.gl().Begin(GL_QUADS);
    for (int i = 0; i < slices; ++i) {
      for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
        app.gl().TexCoord3d(x, y, slice_z(i));
        app.gl().Vertex3d(x, y, slice_z(i));
      }
    }
    app.gl().End();
  };
  scene.tidy_up = [](GlApplication& app) {
    for (const GLenum off : {GL_FRAGMENT_PROGRAM_ARB, GL_VERTEX_PROGRAM_ARB, GL_BLEND}) app.gl().Disable(off);
  };
  return scene;
}

SliceScene core_batched() {
  SliceScene scene{"core profile, one batched draw of triangles from a buffer", Profile::core};
  auto name = std::make_shared<GLuint>(0);
  auto array = std::make_shared<GLuint>(0);
  scene.set_up = [name, array](GlApplication& app) {
    scalar_texture(app.gl(), GL_R8, GL_RED);
    table_texture(app.gl());
    *name = program(app.gl(),
                    "#version 330\n"
                    "uniform mat4 camera; in vec3 corner; out vec3 place;\n"
                    "void main() { place = corner; gl_Position = camera * vec4(corner, 1.0); }\n",
                    "#version 330\n"
                    "uniform sampler3D field; uniform sampler1D table; in vec3 place; out vec4 colour;\n"
                    "void main() { colour = texture(table, texture(field, place).r); }\n");
    app.gl().UseProgram(*name);
    app.gl().Uniform1i(app.gl().GetUniformLocation(*name, "field"), 0);
    app.gl().Uniform1i(app.gl().GetUniformLocation(*name, "table"), 1);
    std::vector<GLfloat> triangles;
    for (int i = 0; i < slices; ++i) {
      std::array<GLfloat, 12> q{};
      quad_corners(slice_z(i), q);
      for (const std::size_t corner : {0, 1, 2, 0, 2, 3}) {
        triangles.insert(triangles.end(), {q[3 * corner], q[3 * corner + 1], q[3 * corner + 2]});
      }
    }
    GLuint buffer = 0;
    app.gl().GenVertexArrays(1, array.get());
    app.gl().BindVertexArray(*array);
    app.gl().GenBuffers(1, &buffer);
    app.gl().BindBuffer(GL_ARRAY_BUFFER, buffer);
    app.gl().BufferData(GL_ARRAY_BUFFER, GLsizeiptr(triangles.size() * sizeof(GLfloat)), triangles.data(),
                        GL_STATIC_DRAW);
    app.gl().EnableVertexAttribArray(3);
    app.gl().VertexAttribPointer(3, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  };
  scene.slices = [name, array](GlApplication& app, double angle) {
    app.gl().Enable(GL_BLEND);
    app.gl().BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    app.gl().UseProgram(*name);
    const Matrix camera = camera_matrix(angle);
    app.gl().UniformMatrix4fv(app.gl().GetUniformLocation(*name, "camera"), 1, GL_FALSE, camera.data());
    app.gl().BindVertexArray(*array);
    app.gl().DrawArrays(GL_TRIANGLES, 0, 6 * slices);
  };
  scene.tidy_up = [](GlApplication& app) { app.gl().Disable(GL_BLEND); };
  return scene;
}

SliceScene fogged_polygons() {
  SliceScene scene{"polygons in fog, GLSL 1.20, a float texture defined twice, scale and bias, an idle mask"};
  auto name = std::make_shared<GLuint>(0);
  scene.set_up = [name](GlApplication& app) {
    const Blob blob;
    std::vector<float> values;
    for (const std::uint8_t s : blob.texels()) values.push_back(float(s) - 40);
    GLuint texture = 0;
    app.gl().GenTextures(1, &texture);
    app.gl().BindTexture(GL_TEXTURE_3D, texture);
    filter(app.gl(), GL_TEXTURE_3D, GL_LINEAR);
    for (const GLint format : {GL_R16F, GL_R32F})
      app.gl().TexImage3D(GL_TEXTURE_3D, 0, format, blob.x, blob.y, blob.z, 0, GL_RED, GL_FLOAT, values.data());
    table_texture(app.gl());
    *name = program(app.gl(),
                    "#version 120\n"
                    "varying float fog; varying vec3 unwritten; varying vec2 backdrop;\n"
                    "void main() {\n"
                    "  vec4 eye = gl_ModelViewMatrix * gl_Vertex;\n"
                    "  gl_TexCoord[0] = gl_MultiTexCoord0;\n"
                    "  gl_Position = gl_ProjectionMatrix * eye;\n"
                    "  fog = (4.0 + eye.z) * 0.6;\n"
                    "  backdrop = gl_Position.xy / gl_Position.w;\n"
                    "}\n",
                    "#version 120\n"
                    "uniform sampler3D field; uniform sampler1D table; uniform sampler3D mask;\n"
                    "uniform bool masked; uniform float scale; uniform float bias; uniform vec3 background;\n"
                    "varying float fog; varying vec3 unwritten; varying vec2 backdrop;\n"
                    "void main() {\n"
                    "  if (masked && texture3D(mask, gl_TexCoord[0].xyz).r > 0.5) discard;\n"
                    "  float v = texture3D(field, gl_TexCoord[0].xyz).r * scale + bias;\n"
                    "  if (v < 0.0 || v > 1.0) discard;\n"
                    "  vec4 colour = texture1D(table, v);\n"
                    "  if (colour.a == 0.0) discard;\n"
                    "  gl_FragColor = fog >= 1.0 ? colour : vec4(mix(background, colour.rgb, fog), colour.a);\n"
                    "}\n");
    app.gl().UseProgram(*name);
    const auto location = [&](const char* uniform) { return app.gl().GetUniformLocation(*name, uniform); };
    app.gl().Uniform1i(location("field"), 0);
    app.gl().Uniform1i(location("table"), 1);
    app.gl().Uniform1i(location("mask"), 5);
    app.gl().Uniform1i(location("masked"), 0);
    app.gl().Uniform1f(location("scale"), 1.0F / 255);
    app.gl().Uniform1f(location("bias"), 40.0F / 255);
    app.gl().Uniform3f(location("background"), 0.9F, 0.7F, 0.1F);
    app.gl().UseProgram(0);
  };
  scene.slices = [name](GlApplication& app, double angle) {
    fixed_function_camera(app.gl(), angle);
    app.gl().Enable(GL_BLEND);
    app.gl().BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    app.gl().DepthMask(GL_FALSE);
    app.gl().UseProgram(*name);
    for (int i = 0; i < slices; ++i) {
      app.gl().Begin(GL_POLYGON);
      for (const auto& [x, y] : {std::pair{0.0F, 0.0F}, {1.0F, 0.0F}, {1.0F, 1.0F}, {0.0F, 1.0F}}) {
        const std::array<GLfloat, 3> place{x, y, GLfloat(slice_z(i))};
        app.gl().TexCoord3fv(place.data());
        app.gl().Vertex3fv(place.data());
      }
      app.gl().End();
    }
  };
  scene.tidy_up = [](GlApplication& app) {
    app.gl().UseProgram(0);
    app.gl().DepthMask(GL_TRUE);
    app.gl().Disable(GL_BLEND);
  };
  return scene;
}

SliceScene pre_integrated_slices(bool along_rays) {
  SliceScene scene{along_rays ? "segments along rays, GLSL 1.20" : "segments of one vector, GLSL 1.20"};
  auto name = std::make_shared<GLuint>(0);
  scene.set_up = [name](GlApplication& app) {
    const DispatchTable& gl = app.gl();
    const Blob blob;
    std::vector<float> values;
    for (const std::uint8_t s : blob.texels()) values.push_back(float(s) / 255);
    GLuint texture = 0;
    gl.GenTextures(1, &texture);
    gl.BindTexture(GL_TEXTURE_3D, texture);
    filter(gl, GL_TEXTURE_3D, GL_LINEAR);
    gl.TexImage3D(GL_TEXTURE_3D, 0, GL_R32F, blob.x, blob.y, blob.z, 0, GL_RED, GL_FLOAT, values.data());
    // Only a narrow band of values is visible: segments with ends on both sides of the band show it, single
    // samples do not.
    constexpr int edge = 256;
    const auto below = [](double s) { return 0.02 * s + 0.5 / (1 + std::exp(-60 * (s - 0.55))); };
    std::vector<float> table;
    for (int back = 0; back < edge; ++back) {
      for (int front = 0; front < edge; ++front) {
        const double f = front / 255.0;
        const double b = back / 255.0;
        const double slope = 0.02 + 30 * std::exp(-60 * std::abs(f - 0.55)) / 2;
        const double depth = front == back ? 0.01 * slope : 0.3 * std::abs(below(b) - below(f));
        table.insert(table.end(), {float(f), float(0.5 + 0.5 * std::sin(5 * b)), float(1 - 0.5 * (f + b)),
                                   float(1 - std::exp(-depth))});
      }
    }
    gl.GenTextures(1, &texture);
    gl.ActiveTexture(GL_TEXTURE1);
    gl.BindTexture(GL_TEXTURE_2D, texture);
    filter(gl, GL_TEXTURE_2D, GL_LINEAR);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, edge, edge, 0, GL_RGBA, GL_FLOAT, table.data());
    gl.ActiveTexture(GL_TEXTURE0);
    *name = program(gl,
                    "#version 120\n"
                    "uniform mat4 camera; uniform vec3 segment; uniform vec4 eye; attribute vec3 corner;\n"
                    "varying vec3 front; varying vec3 back;\n"
                    "void main() {\n"
                    "  front = corner;\n"
                    "  vec3 ray = corner - eye.xyz;\n"
                    "  back = front + mix(segment, segment.z / ray.z * ray, eye.w);\n"
                    "  gl_Position = camera * vec4(corner, 1.0);\n"
                    "}\n",
                    "#version 120\n"
                    "uniform sampler3D field; uniform sampler2D table; varying vec3 front; varying vec3 back;\n"
                    "void main() {\n"
                    "  vec2 ends = vec2(texture3D(field, front).r, texture3D(field, back).r);\n"
                    "  gl_FragColor = texture2D(table, (ends * 255.0 + 0.5) / 256.0);\n"
                    "}\n");
    gl.UseProgram(*name);
    gl.Uniform1i(gl.GetUniformLocation(*name, "field"), 0);
    gl.Uniform1i(gl.GetUniformLocation(*name, "table"), 1);
    gl.UseProgram(0);
  };
  auto array = std::make_shared<std::vector<std::array<GLfloat, 12>>>(slices);
  scene.slices = [name, array, along_rays](GlApplication& app, double angle) {
    const DispatchTable& gl = app.gl();
    blend_over(gl);
    gl.UseProgram(*name);
    const Matrix camera = camera_matrix(angle);
    gl.UniformMatrix4fv(gl.GetUniformLocation(*name, "camera"), 1, GL_FALSE, camera.data());
    gl.Uniform3f(gl.GetUniformLocation(*name, "segment"), 0, 0, -1.0F / slices);
    const double turned = angle * M_PI / 180;
    gl.Uniform4f(gl.GetUniformLocation(*name, "eye"), GLfloat(0.5 - 3 * std::sin(turned)), 0.5F,
                 GLfloat(0.5 + 3 * std::cos(turned)), along_rays ? 1 : 0);
    for (int i = 0; i < slices; ++i) quad_corners(slice_z(i), (*array)[std::size_t(i)]);
    gl.EnableVertexAttribArray(3);
    gl.VertexAttribPointer(3, 3, GL_FLOAT, GL_FALSE, 0, array->data());
    gl.DrawArrays(GL_QUADS, 0, 4 * slices);
  };
  scene.tidy_up = [](GlApplication& app) {
    app.gl().DisableVertexAttribArray(3);
    app.gl().UseProgram(0);
    app.gl().Disable(GL_BLEND);
  };
  return scene;
}

SliceScene fixed_function_fog(GLenum mode) {
  SliceScene scene = immediate_rgba();
  scene.name = "fixed function in fog";
  scene.set_up = [](GlApplication& app) { scalar_texture(app.gl(), GL_INTENSITY8, GL_LUMINANCE); };
  scene.slices = [mode, slices_alone = scene.slices](GlApplication& app, double angle) {
    const std::array<GLfloat, 4> haze{0.9F, 0.3F, 0.1F, 1};
    app.gl().Fogi(GL_FOG_MODE, GLint(mode));
    app.gl().Fogfv(GL_FOG_COLOR, haze.data());
    app.gl().Fogf(GL_FOG_START, 2.5F);
    app.gl().Fogf(GL_FOG_END, 3.3F);
    app.gl().Fogf(GL_FOG_DENSITY, 0.25F);
    app.gl().Enable(GL_FOG);
    slices_alone(app, angle);
  };
  scene.tidy_up = [tidy_up_slices = scene.tidy_up](GlApplication& app) {
    tidy_up_slices(app);
    app.gl().Disable(GL_FOG);
  };
  return scene;
}

SliceScene texture_stack_program(Profile profile, GLenum internal_format) {
  SliceScene scene{"a stack of 2-D textures under GLSL", profile};
  auto stack = std::make_shared<std::vector<GLuint>>();
  auto name = std::make_shared<GLuint>(0);
  scene.set_up = [stack, name, profile, internal_format](GlApplication& app) {
    const DispatchTable& gl = app.gl();
    const Blob blob;
    const auto texels = blob.texels();
    stack->resize(std::size_t(blob.z));
    gl.GenTextures(blob.z, stack->data());
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    for (int z = 0; z < blob.z; ++z) {
      gl.BindTexture(GL_TEXTURE_2D, (*stack)[std::size_t(z)]);
      filter(gl, GL_TEXTURE_2D, GL_LINEAR);
      gl.TexImage2D(GL_TEXTURE_2D, 0, GLint(internal_format), blob.x, blob.y, 0, GL_RED, GL_UNSIGNED_BYTE,
                    &texels[z * blob.x * blob.y]);
    }
    table_texture(gl);
    const bool core = profile == Profile::core;
    *name = program(gl,
                    core ? "#version 330\n"
                           "uniform mat4 camera; in vec3 corner; out vec2 place;\n"
                           "void main() { place = corner.xy; gl_Position = camera * vec4(corner, 1.0); }\n"
                         : nullptr,
                    core ? "#version 330\n"
                           "uniform sampler2D field; uniform sampler1D table; in vec2 place; out vec4 colour;\n"
                           "void main() { colour = texture(table, texture(field, place).r); }\n"
                         : "#version 120\n"
                           "uniform sampler2D field; uniform sampler1D table;\n"
                           "void main() {\n"
                           "  gl_FragColor = texture1D(table, texture2D(field, gl_TexCoord[0].xy).r);\n"
                           "}\n");
    gl.UseProgram(*name);
    gl.Uniform1i(gl.GetUniformLocation(*name, "field"), 0);
    gl.Uniform1i(gl.GetUniformLocation(*name, "table"), 1);
    gl.UseProgram(0);
    if (!core) return;
    std::vector<GLfloat> triangles;
    for (int z = 0; z < blob.z; ++z) {
      std::array<GLfloat, 12> q{};
      quad_corners((z + 0.5) / blob.z, q);
      for (const std::size_t corner : {0, 1, 2, 0, 2, 3})
        triangles.insert(triangles.end(), {q[3 * corner], q[3 * corner + 1], q[3 * corner + 2]});
    }
    GLuint array = 0;
    GLuint buffer = 0;
    gl.GenVertexArrays(1, &array);
    gl.BindVertexArray(array);
    gl.GenBuffers(1, &buffer);
    gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl.BufferData(GL_ARRAY_BUFFER, GLsizeiptr(triangles.size() * sizeof(GLfloat)), triangles.data(),
                  GL_STATIC_DRAW);
    gl.EnableVertexAttribArray(3);
    gl.VertexAttribPointer(3, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  };
  scene.slices = [stack, name, profile](GlApplication& app, double angle) {
    if (profile == Profile::compatibility) fixed_function_camera(app.gl(), angle);
    blend_over(app.gl());
    app.gl().UseProgram(*name);
    const Matrix camera = camera_matrix(angle);
    if (profile == Profile::core)
      app.gl().UniformMatrix4fv(app.gl().GetUniformLocation(*name, "camera"), 1, GL_FALSE, camera.data());
    const std::size_t n = stack->size();
    const bool from_behind = std::cos(angle * M_PI / 180) < 0;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t slice = from_behind ? n - 1 - i : i;
      app.gl().ActiveTexture(GL_TEXTURE0);
      app.gl().BindTexture(GL_TEXTURE_2D, (*stack)[slice]);
      if (profile == Profile::core) {
        app.gl().DrawArrays(GL_TRIANGLES, GLint(6 * slice), 6);
        continue;
      }
      app.gl().Begin(GL_QUADS);
      for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
        app.gl().TexCoord2d(x, y);
        app.gl().Vertex3d(x, y, (double(slice) + 0.5) / double(n));
      }
      app.gl().End();
    }
  };
  scene.tidy_up = [](GlApplication& app) {
    app.gl().UseProgram(0);
    app.gl().Disable(GL_BLEND);
  };
  return scene;
}

SliceScene view_space_slices() {
  SliceScene scene{"corners in the eye's space, a projection alone", Profile::core};
  auto name = std::make_shared<GLuint>(0);
  auto array = std::make_shared<GLuint>(0);
  scene.set_up = [name, array](GlApplication& app) {
    const DispatchTable& gl = app.gl();
    scalar_texture(gl, GL_R8, GL_RED);
    table_texture(gl);
    *name = program(gl,
                    "#version 330\n"
                    "uniform mat4 projection; in vec3 corner; in vec3 coordinate; out vec3 place;\n"
                    "void main() { place = coordinate; gl_Position = projection * vec4(corner, 1.0); }\n",
                    "#version 330\n"
                    "uniform sampler3D field; uniform sampler1D table; in vec3 place; out vec4 colour;\n"
                    "void main() { colour = texture(table, texture(field, place).r); }\n");
    gl.UseProgram(*name);
    gl.Uniform1i(gl.GetUniformLocation(*name, "field"), 0);
    gl.Uniform1i(gl.GetUniformLocation(*name, "table"), 1);
    GLuint buffer = 0;
    gl.GenVertexArrays(1, array.get());
    gl.BindVertexArray(*array);
    gl.GenBuffers(1, &buffer);
    gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
    const auto coordinate = GLuint(gl.GetAttribLocation(*name, "coordinate"));
    constexpr GLsizei stride = 6 * sizeof(GLfloat);
    gl.EnableVertexAttribArray(3);
    gl.VertexAttribPointer(3, 3, GL_FLOAT, GL_FALSE, stride, nullptr);
    gl.EnableVertexAttribArray(coordinate);
    gl.VertexAttribPointer(coordinate, 3, GL_FLOAT, GL_FALSE, stride,
                           reinterpret_cast<const void*>(3 * sizeof(GLfloat)));
  };
  scene.slices = [name, array](GlApplication& app, double angle) {
    const DispatchTable& gl = app.gl();
    const double c = std::cos(angle * M_PI / 180);
    const double s = std::sin(angle * M_PI / 180);
    std::vector<GLfloat> triangles;
    for (int i = 0; i < slices; ++i) {
      std::array<GLfloat, 12> q{};
      quad_corners(slice_z(i), q);
      for (const std::size_t corner : {0, 1, 2, 0, 2, 3}) {
        const double x = q[3 * corner] - 0.5;
        const double y = q[3 * corner + 1] - 0.5;
        const double z = q[3 * corner + 2] - 0.5;
        triangles.insert(triangles.end(), {GLfloat(c * x + s * z), GLfloat(y), GLfloat(-s * x + c * z - 3),
                                           q[3 * corner], q[3 * corner + 1], q[3 * corner + 2]});
      }
    }
    // The buffer is larger than the drawn part: the remainder repeats one corner.
    triangles.resize(triangles.size() + 6 * 30);
    gl.BufferData(GL_ARRAY_BUFFER, GLsizeiptr(triangles.size() * sizeof(GLfloat)), triangles.data(),
                  GL_STREAM_DRAW);
    blend_over(gl);
    gl.UseProgram(*name);
    constexpr float near = 1;
    constexpr float far = 10;
    const Matrix projection{3.3F,
                            0,
                            0,
                            0,
                            0,
                            3.3F,
                            0,
                            0,
                            0,
                            0,
                            (far + near) / (near - far),
                            -1,
                            0,
                            0,
                            2 * far * near / (near - far),
                            0};
    gl.UniformMatrix4fv(gl.GetUniformLocation(*name, "projection"), 1, GL_FALSE, projection.data());
    gl.BindVertexArray(*array);
    gl.DrawArrays(GL_TRIANGLES, 0, GLsizei(triangles.size() / 6));
  };
  scene.tidy_up = [](GlApplication& app) { app.gl().Disable(GL_BLEND); };
  return scene;
}

SliceScene degenerate_strip() {
  SliceScene scene = core_batched();
  scene.name = "core profile, one strip with degenerate triangles";
  scene.set_up = [set_up = scene.set_up](GlApplication& app) {
    set_up(app);
    std::vector<GLfloat> strip;
    for (int i = 0; i < slices; ++i) {
      std::array<GLfloat, 12> q{};
      quad_corners(slice_z(i), q);
      for (const std::size_t corner : {0, 0, 1, 3, 2, 2})
        strip.insert(strip.end(), {q[3 * corner], q[3 * corner + 1], q[3 * corner + 2]});
    }
    app.gl().BufferData(GL_ARRAY_BUFFER, GLsizeiptr(strip.size() * sizeof(GLfloat)), strip.data(),
                        GL_STATIC_DRAW);
  };
  scene.slices = [](GlApplication& app, double angle) {
    blend_over(app.gl());
    GLint program = 0;
    app.driver().GetIntegerv(GL_CURRENT_PROGRAM, &program);
    const Matrix camera = camera_matrix(angle);
    app.gl().UniformMatrix4fv(app.gl().GetUniformLocation(GLuint(program), "camera"), 1, GL_FALSE,
                              camera.data());
    app.gl().DrawArrays(GL_TRIANGLE_STRIP, 0, 6 * slices);
  };
  return scene;
}

std::vector<SliceScene> all_slice_scenes() {
  return {immediate_rgba(),        display_list_texgen(),   client_arrays_table(),
          vertex_shader_varying(), assembly_program(false), assembly_program(true),
          texture_stack(),         core_batched(),          fogged_polygons()};
}

void replace_shader(GlApplication& app, GLenum stage, const char* source) {
  constexpr GLuint program = 1;
  std::array<GLuint, 4> shaders{};
  GLsizei count = 0;
  app.gl().GetAttachedShaders(program, GLsizei(shaders.size()), &count, shaders.data());
  for (GLsizei i = 0; i < count; ++i) {
    GLint type = 0;
    app.gl().GetShaderiv(shaders[std::size_t(i)], GL_SHADER_TYPE, &type);
    if (GLenum(type) != stage) continue;
    app.gl().ShaderSource(shaders[std::size_t(i)], 1, &source, nullptr);
    app.gl().CompileShader(shaders[std::size_t(i)]);
  }
  app.gl().LinkProgram(program);
  app.gl().UseProgram(program);
  app.gl().Uniform1i(app.gl().GetUniformLocation(program, "field"), 0);
  app.gl().Uniform1i(app.gl().GetUniformLocation(program, "table"), 1);
  app.gl().UseProgram(0);
}

}  // namespace understudy::spu::testing
