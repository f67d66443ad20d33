// SPDX-License-Identifier: Apache-2.0
// Runs the prototype of a ray caster (in the folder that raycast.py names) on a processor without
// AVX-512. The prototype's own program begins with its AVX-512 kernels; this program includes it
// unchanged and times only its AVX2 kernel, in the same way and with the same output. Built by
// raycast.py.
//
// The kernels are templates, so the AVX-512 ones are compiled only if the prototype's main is. The macro
// turns that main into a template, too.
#define main(...)  \
  unused_status;   \
  template <class> \
  int unused_program(__VA_ARGS__)
#include "yardstick.cpp"
#undef main

int main(int count, char** words) {
  if (count != 8) {
    std::fputs("yardstick_avx2 VOLUME VOXELS PIXELS TABLE THREADS FRAMES EPSILON\n", stderr);
    return 2;
  }
  const int threads = std::atoi(words[5]), frames = std::atoi(words[6]);
  g_eps = float(std::atof(words[7]));
  const Scene scene = load(words[1], std::atoi(words[2]), std::atoi(words[3]), 1, words[4]);
  const long samples = countsamples(scene);
  Occ occupied;
  minmax(scene, occupied);
  distmap(scene, occupied);
  const NV bricks = build(scene);
  std::vector<float> images(4 * std::size_t(scene.W) * std::size_t(scene.W));
  auto* const table = static_cast<float*>(std::aligned_alloc(64, 64 * 70));  // 256 entries and an empty one
  std::memset(table, 0, 64 * 70);
  for (int i = 0; i < 256; ++i)
    for (int k = 0; k < 4; ++k) table[4 * i + k] = k == 3 ? -scene.tff[i][3] : scene.tff[i][k];
  const Ctx context{&scene, &bricks, &occupied, table, nullptr, images.data()};
  std::vector<double> times;
  for (int frame = 0; frame < frames; ++frame) {
    const double before = ucpu();
    std::atomic<int> next(0);
    constexpr int tile = 32;
    const int along = scene.W / tile;
    const auto work = [&] {
      for (int i = next++; i < along * along; i = next++)
        tile256<5, true, true, 8>(context, i % along * tile, i / along * tile, tile);
    };
    std::vector<std::thread> others;
    for (int i = 1; i < threads; ++i) others.emplace_back(work);
    work();
    for (std::thread& other : others) other.join();
    times.push_back(ucpu() - before);
  }
  std::sort(times.begin(), times.end());
  std::printf("AVX2   post float4    ert1 skip1 | %.2f ns/full.core\n",
              times[times.size() / 2] / double(samples) * 1e9);
  std::free(table);
}
