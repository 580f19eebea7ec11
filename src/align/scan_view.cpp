// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/scan_view.h"

#include <algorithm>
#include <cmath>

#include "align/edges.h"
#include "base/parallel.h"
#include "cloud/selection.h"
#include "raster/occlusion.h"
#include "raster/splat_pass.h"

namespace alidade {

namespace {

constexpr double kWantedSpacingPx = 0.5;
constexpr std::uint32_t kPointsPerTask = 16384;
/// Holes are filled from so many halvings of the picture: up to eight pixels between points.
constexpr int kFillLevels = 3;
/// A point counts where it lies on the visible surface within this.
constexpr float kOnSurfaceM = 0.02f, kOnSurfaceShare = 0.006f;

/// Brightness times weight, and weight.
struct Sum {
  float light = 0, weight = 0;
};

float lumaOf(std::uint16_t rgb565) {
  const float r = static_cast<float>(rgb565 >> 11) * (255.0f / 31.0f);
  const float g = static_cast<float>(rgb565 >> 5 & 63) * (255.0f / 63.0f);
  const float b = static_cast<float>(rgb565 & 31) * (255.0f / 31.0f);
  return 0.299f * r + 0.587f * g + 0.114f * b;
}

struct Spreader {
  const DepthImage& depth;
  Image<Sum>& sums;

  /// The farthest of the surface around the place: a slanted surface runs through several depths.
  bool isVisible(int x, int y, float z) const {
    float farthest = 0;
    for (int dy = 0; dy < 2; ++dy)
      for (int dx = 0; dx < 2; ++dx)
        if (const float d = depth.at(x + dx, y + dy); d > farthest) farthest = d;
    return z <= farthest + kOnSurfaceM + kOnSurfaceShare * z;
  }

  void add(float u, float v, float z, float light) const {
    const float fu = std::floor(u), fv = std::floor(v);
    const int x = static_cast<int>(fu), y = static_cast<int>(fv);
    if (x < 0 || y < 0 || x + 1 >= sums.width() || y + 1 >= sums.height() || !isVisible(x, y, z)) return;
    const float a = u - fu, b = v - fv;
    const float w[4] = {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b};
    for (int i = 0; i < 4; ++i) {
      Sum& sum = sums.at(x + (i & 1), y + (i >> 1));
      sum.light += w[i] * light, sum.weight += w[i];
    }
  }
};

void spread(const SplatRun& run, std::uint32_t first, std::uint32_t count, const Spreader& to) {
  const SplatView& v = run.view;
  for (const DisplayPoint* p = run.points + first; p != run.points + first + count; ++p) {
    const auto sx = static_cast<float>(p->x), sy = static_cast<float>(p->y), sz = static_cast<float>(p->z);
    const float z = v.m[6] * sx + v.m[7] * sy + v.m[8] * sz + v.t[2];
    if (!(z > 0.05f)) continue;
    const float x = (v.m[0] * sx + v.m[1] * sy + v.m[2] * sz + v.t[0]) / z;
    const float y = (v.m[3] * sx + v.m[4] * sy + v.m[5] * sz + v.t[1]) / z;
    const float r2 = x * x + y * y;
    if (r2 >= v.foldBackSquared || (v.checkDomain && r2 >= v.surelyInsideSquared && !v.inDomain(v.camera, x, y))) continue;
    float xd = 0, yd = 0;
    distort(v.lens, x, y, xd, yd);
    to.add(v.fx * xd + v.cx, v.fy * yd + v.cy, z, lumaOf(p->rgb565));
  }
}

Image<Sum> spreadAll(const std::vector<SplatLayer>& layers, const Camera& camera, const RigidTransform& pose,
                     const DepthImage& depth) {
  struct Task {
    std::size_t run;
    std::uint32_t first, count;
  };
  const SplatOptions options;
  const SplatView base = baseView(camera, options);
  std::vector<SplatRun> runs;
  std::vector<Task> tasks;
  for (const SplatLayer& layer : layers)
    for (const SelectedRange& range : layer.selection.ranges) {
      runs.push_back(makeRun(*layer.store, range, pose, base, options));
      for (std::uint32_t first = 0; first < range.count; first += kPointsPerTask)
        tasks.push_back({runs.size() - 1, first, std::min(kPointsPerTask, range.count - first)});
    }
  std::vector<Image<Sum>> planes(workerCount());
  parallelFor(tasks.size(), 1, [&](std::size_t first, std::size_t last, int worker) {
    if (planes[worker].empty()) planes[worker] = Image<Sum>(camera.width(), camera.height());
    for (std::size_t i = first; i < last; ++i)
      spread(runs[tasks[i].run], tasks[i].first, tasks[i].count, {depth, planes[worker]});
  });
  Image<Sum> sums(camera.width(), camera.height());
  for (const Image<Sum>& plane : planes)
    for (std::size_t i = 0; i < plane.size(); ++i) {
      sums.data()[i].light += plane.data()[i].light;
      sums.data()[i].weight += plane.data()[i].weight;
    }
  return sums;
}

/// Half the size, sums of four; a weight beyond one tells no more.
Image<Sum> pulled(const Image<Sum>& fine) {
  Image<Sum> coarse((fine.width() + 1) / 2, (fine.height() + 1) / 2);
  for (int y = 0; y < fine.height(); ++y)
    for (int x = 0; x < fine.width(); ++x) {
      const Sum& from = fine.at(x, y);
      Sum& to = coarse.at(x / 2, y / 2);
      to.light += from.light, to.weight += from.weight;
    }
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    Sum& sum = coarse.data()[i];
    const float most = 1.0f / std::max(1.0f, sum.weight);
    sum.light *= most, sum.weight *= most;
  }
  return coarse;
}

/// Adds what the coarser picture knows where the finer one knows little.
void push(const Image<Sum>& coarse, Image<Sum>& fine) {
  const auto place = [](int i, int size, int& low, float& share) {
    const float at = std::clamp(0.5f * static_cast<float>(i) - 0.25f, 0.0f, static_cast<float>(size - 1));
    low = std::min(static_cast<int>(at), std::max(0, size - 2));
    share = at - static_cast<float>(low);
  };
  for (int y = 0; y < fine.height(); ++y) {
    int y0 = 0;
    float b = 0;
    place(y, coarse.height(), y0, b);
    const int y1 = std::min(y0 + 1, coarse.height() - 1);
    for (int x = 0; x < fine.width(); ++x) {
      Sum& to = fine.at(x, y);
      if (to.weight >= 1) continue;
      int x0 = 0;
      float a = 0;
      place(x, coarse.width(), x0, a);
      const int x1 = std::min(x0 + 1, coarse.width() - 1);
      const Sum& p = coarse.at(x0, y0), &q = coarse.at(x1, y0), &r = coarse.at(x0, y1), &s = coarse.at(x1, y1);
      const float missing = 1 - to.weight;
      to.light += missing * ((1 - b) * ((1 - a) * p.light + a * q.light) + b * ((1 - a) * r.light + a * s.light));
      to.weight += missing * ((1 - b) * ((1 - a) * p.weight + a * q.weight) + b * ((1 - a) * r.weight + a * s.weight));
    }
  }
}

void fillHoles(Image<Sum>& sums, int levels) {
  if (levels == 0 || sums.width() < 4 || sums.height() < 4) return;
  Image<Sum> coarse = pulled(sums);
  fillHoles(coarse, levels - 1);
  push(coarse, sums);
}

double shareOf(const Image<std::uint8_t>& covered) {
  const auto count = std::count(covered.data(), covered.data() + covered.size(), std::uint8_t{1});
  return covered.size() == 0 ? 0 : static_cast<double>(count) / static_cast<double>(covered.size());
}

ScanView edgeView(ScanView view, bool complete) {
  view.ofEdges = true;
  view.luma = depthEdges(view.depth, complete, view.covered);
  view.coverage = shareOf(view.covered);
  return view;
}

}  // namespace

bool AlignmentScene::hasColour() const {
  return std::any_of(scans.begin(), scans.end(), [](const auto& scan) {
    return scan->attribute("rgb") != nullptr || scan->attribute("intensity") != nullptr;
  });
}

double AlignmentScene::spacingM() const {
  double spacing = 0;
  for (const auto& scan : scans) spacing = std::max(spacing, scan->medianSpacing());
  return spacing;
}

ScanView drawScanView(const AlignmentScene& scene, const Camera& camera, const RigidTransform& cameraFromWorld) {
  SelectionOptions wanted;
  wanted.targetSpacingPx = kWantedSpacingPx;
  wanted.byFacing = false;  // what hides is judged by the gaps between dots
  const std::vector<Selection> chosen = select(scene.scans, camera, cameraFromWorld, wanted);
  std::vector<SplatLayer> layers;
  for (std::size_t i = 0; i < chosen.size(); ++i) layers.push_back({scene.scans[i], chosen[i]});

  ScanView view;
  view.depth = occlusionDepth(layers, camera, cameraFromWorld).depth;
  if (!scene.surfaces.empty()) {
    const DepthImage behind = occlusionDepth(Occluders{{}, scene.surfaces}, camera, cameraFromWorld).depth;
    for (std::size_t i = 0; i < behind.size(); ++i)
      if (std::isnan(view.depth.data()[i])) view.depth.data()[i] = behind.data()[i];
  }
  if (!scene.hasColour()) return edgeView(std::move(view), scene.complete);
  Image<Sum> sums = spreadAll(layers, camera, cameraFromWorld, view.depth);
  fillHoles(sums, kFillLevels);
  view.luma = Image<float>(camera.width(), camera.height());
  view.covered = Image<std::uint8_t>(camera.width(), camera.height());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const Sum& sum = sums.data()[i];
    if (!(sum.weight > 0.25f) || !(view.depth.data()[i] > 0)) continue;
    view.luma.data()[i] = sum.light / sum.weight;
    view.covered.data()[i] = 1;
  }
  view.coverage = shareOf(view.covered);
  return view;
}

}  // namespace alidade
