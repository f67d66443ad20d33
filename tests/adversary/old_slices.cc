// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/old_slices.h"

namespace adversary {

const std::string old_vertex_shader = R"(
void main() {
  gl_TexCoord[0] = gl_MultiTexCoord0;
  gl_Position = ftransform();
}
)";

void begin_old_frame(const Canvas& canvas, const Camera& camera) {
  canvas.begin(0.1F, 0.12F, 0.2F);
  canvas.gl.MatrixMode(GL_PROJECTION);
  canvas.gl.LoadMatrixf(camera.projection.data());
  canvas.gl.MatrixMode(GL_MODELVIEW);
  canvas.gl.LoadMatrixf(camera.view.data());
}

void draw_polygons(const Gl& gl, const std::vector<Polygon>& polygons) {
  for (const Polygon& polygon : polygons) {
    gl.Begin(GL_POLYGON);
    for (const Vector& corner : polygon) {
      gl.TexCoord3f(corner.x, corner.y, corner.z);
      gl.Vertex3f(corner.x, corner.y, corner.z);
    }
    gl.End();
  }
}

Camera old_camera(const Canvas& canvas, int frame, const Orbit& orbit) {
  return camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
}

}  // namespace adversary
