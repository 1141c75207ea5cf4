#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "frames.hpp"
#include "kernels/intrinsic/scaled_intrinsic.hpp"
#include "tests/bench/metrics.hpp"
#include "tests/bench/scene.hpp"
#include "tests/bench/device_session.hpp"

using namespace inverse;
using namespace inverse::bench;

static double rms(const Image& a, const Image& b) {
  double s = 0, q = 0, n = 0;
  for (size_t i = 0; i < a.data.size(); ++i) {
    const double d = std::log(std::max(double(a.data[i]), 1e-6) / std::max(double(b.data[i]), 1e-6));
    s += d, q += d * d, ++n;
  }
  return std::sqrt(std::max(q / n - s * s / n / n, 0.0));
}

int main(int argc, char** argv) {
  DeviceSession session("");
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i)
    for (const auto& e : std::filesystem::directory_iterator(argv[i])) files.push_back(e.path());
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    Scene scene;
    if (file.ends_with(".dump")) {
      scene.set = "real", scene.name = std::filesystem::path(file).stem(), scene.video = true;
      for (const auto& f : read_frames(file)) {
        TruthFrame t;
        t.input = Image(int(f.extent.width), int(f.extent.height), 3);
        for (size_t i = 0; i < f.extent.pixels(); ++i)
          for (size_t c = 0; c < 3; ++c) t.input.data[3 * i + c] = f.pixels[4 * i + c];
        scene.frames.push_back(t);
      }
    } else scene = read_scene(file);
    if (scene.name == "slow light") continue;
    const Extent extent{uint32_t(scene.frames[0].input.width), uint32_t(scene.frames[0].input.height)};
    ScaledIntrinsic full(session.device(), extent), half(session.device(), extent), nobins(session.device(), extent), cold(session.device(), extent);
    ScaledIntrinsic::Params pf, ph, pb, p;
    ph.half_resolution = true;
    pb.prior.chroma_weight = 0;
    const auto run = [&](ScaledIntrinsic& m, const ScaledIntrinsic::Params& q, const Image& in, bool reset) {
      Cost cost;
      return session.run(in, [&](gpu::Commands& c, const PlanePtr& i) { return m.record(c, i, q, {reset})[Role::intrinsic]; }, cost);
    };
    const size_t n = std::min<size_t>(scene.frames.size(), 10);
    double maxbind = 0, maxgate = 0, dv = 0, dc = 0, db = 0, dbc = 0, count = 0, lf = 0, lh = 0, lb = 0, hc = 0;
    for (size_t k = 0; k < n; ++k) {
      const Image& in = scene.frames[k].input;
      const bool reset = !scene.video || k == 0;
      const auto f = run(full, pf, in, reset), h = run(half, ph, in, reset), b = run(nobins, pb, in, reset);
      const auto fnd = full.findings(full.recorded() - 1);
      maxbind = std::max<double>(maxbind, fnd.binding), maxgate = std::max<double>(maxgate, fnd.gate);
      if (scene.video && k < std::min<size_t>(2, n - 1)) continue;
      const auto cf = run(cold, pf, in, true), ch = run(cold, ph, in, true), cb = run(cold, pb, in, true);
      ++count;
      dv += rms(f.shading, h.shading);
      dc += rms(cf.shading, ch.shading);
      hc += rms(f.shading, ch.shading);
      db += rms(f.shading, b.shading);
      dbc += rms(cf.shading, cb.shading);
      if (!scene.frames[k].reflectance.empty()) {
        const auto l = [&](const Decomposition& d) { return score(d.reflectance, d.shading, scene.frames[k].reflectance, scene.frames[k].shading, scene.frames[k].mask).lmse20; };
        lf += l(f), lh += l(h), lb += l(b);
      }
    }
    const auto fi = full.findings(full.recorded() - 1);
    std::printf("est %.4f fits %d | binding %.4f gate %.4f | ", 0.0, 0, maxbind, maxgate); (void)fi;
    std::printf("%-20s %-14s %4ux%-4u half: video %.4f cold %.4f fullvid-coldhalf %.4f | bins: video %.4f cold %.4f | lmse full %.4f half %.4f nobins %.4f\n", scene.set.c_str(), scene.name.c_str(), extent.width, extent.height, dv / count, dc / count, hc / count, db / count, dbc / count, lf / count, lh / count, lb / count);
    std::fflush(stdout);
  }
}
