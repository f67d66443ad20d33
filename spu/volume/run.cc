#include "spu/volume/run.h"

namespace understudy::spu {

void Run::replay(const DispatchTable& gl) const {
  const auto words = calls_.words();
  std::size_t done = 0;
  for (const ElementDraw& draw : elements_) {
    understudy::spu::replay(words.subspan(done, draw.position - done), gl);
    done = draw.position;
    gl.DrawElements(draw.mode, draw.count, draw.type, draw.offset);
  }
  understudy::spu::replay(words.subspan(done), gl);
}

}  // namespace understudy::spu
