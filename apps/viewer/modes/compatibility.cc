// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/modes/compatibility.h"

#include <GL/glew.h>

namespace viewer {

namespace {

void draw_immediate(GLenum primitive, const std::vector<ColouredVertex>& vertices) {
  glBegin(primitive);
  for (const ColouredVertex& vertex : vertices) {
    glColor3fv(vertex.colour.data());
    glVertex3fv(vertex.position.data());
  }
  glEnd();
}

}  // namespace

void load_matrices(const Matrices& matrices) {
  glMatrixMode(GL_PROJECTION);
  glLoadMatrixf(to_float(matrices.projection).data());
  glMatrixMode(GL_MODELVIEW);
  glLoadMatrixf(to_float(matrices.modelview).data());
}

void draw_opaque_immediate(const OpaqueGeometry& geometry, const Matrices& matrices) {
  load_matrices(matrices);
  draw_immediate(GL_LINES, geometry.lines);
  draw_immediate(GL_TRIANGLES, geometry.triangles);
}

}  // namespace viewer
