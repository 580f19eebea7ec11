// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/splat_pass.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "base/log.h"
#include "base/parallel.h"
#include "raster/hidden_tiles.h"
#include "raster/splat_plane.h"

namespace alidade {

namespace {

/// Squares as wide as the points of a surface are apart on average would leave a third of it bare where they lie at random,
/// so they are wider by this; one pixel as long as that is how far apart they are (closeHoles fills in).
constexpr double kCover = 1.5;
constexpr std::uint32_t kPointsPerTask = 16384;
/// Cells are at least so many times as wide as points are apart. Those of a surface that faces the eye, which the selection wants a pixel
/// apart by default, fall into pixels, though levels are cut in steps; seen at an angle, where they are farther apart on the surface, and
/// unevenly on screen, into cells of two pixels, which have no holes, and into pixels.
constexpr double kCellCover = 0.98;
/// What is hidden is looked up when the nearest share of the wide points is drawn, then each time that they are some times as many.
constexpr std::uint64_t kNearestShare = 8, kMoreBeforeNext = 3, kFewToHide = 300'000;
constexpr std::size_t kRowsPerBand = 64;

struct Task {
  std::uint32_t run;
  std::uint32_t first;
  std::uint32_t count;
  std::uint32_t share = 0;  ///< of the picture, see shareOut()
};

std::vector<Task> tasksOf(std::span<const SplatRun> runs, bool onlyChecked) {
  std::vector<Task> tasks;
  for (std::uint32_t r = 0; r < runs.size(); ++r) {
    if (onlyChecked && !runs[r].view.checkDomain) continue;
    for (std::uint32_t first = 0; first < runs[r].count;
         first += std::min(kPointsPerTask, runs[r].count - first)) {
      tasks.push_back({r, first, std::min(kPointsPerTask, runs[r].count - first)});
    }
  }
  return tasks;
}

/// The part of the picture that a node lies in, about, row by row and to and fro: its pixels stay in the processor's cache while all
/// nodes there are drawn.
std::pair<int, int> regionOf(const SplatRun& run) {
  constexpr double kRegionPx = 128.0, kFarthest = 4.0, kLeastDepth = 0.1;
  const glm::dvec2 ray = glm::dvec2(run.boxMiddle) / std::max(run.boxMiddle.z, kLeastDepth);
  if (!std::isfinite(ray.x) || !std::isfinite(ray.y)) return {0, 0};
  const glm::dvec2 place = glm::floor(glm::clamp(ray, -kFarthest, kFarthest) * glm::dvec2(run.view.fx, run.view.fy) / kRegionPx);
  const int row = static_cast<int>(place.y), column = static_cast<int>(place.x);
  return {row, (row & 1) != 0 ? -column : column};
}

/// Parts of the picture side by side, of as many points each: threads that draw one part each write where no other does, but for
/// nodes on the border, and little is left to join.
void shareOut(std::span<const SplatRun> runs, std::span<Task> tasks, std::size_t shares) {
  std::vector<std::pair<double, std::size_t>> fromLeft;
  std::uint64_t points = 0, before = 0;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const glm::dvec3& middle = runs[tasks[i].run].boxMiddle;
    const double angle = std::atan2(middle.x, middle.z);
    fromLeft.push_back({std::isfinite(angle) ? angle : 0.0, i});
    points += tasks[i].count;
  }
  std::ranges::sort(fromLeft);
  for (const auto& [place, i] : fromLeft) {
    tasks[i].share = static_cast<std::uint32_t>(before * shares / points);
    before += tasks[i].count;
  }
}

/// Fits the surface's cells of runs that draw footprints of more than a pixel, and points the runs at them.
class SurfaceFits {
 public:
  SurfaceFits(std::span<SplatRun> runs, const RigidTransform* cameraFromWorld) : m_runs(runs), m_laid(runs.size(), false) {
    if (cameraFromWorld != nullptr) m_rotation = cameraFromWorld->rotationMatrix();
  }

  /// Runs by number; those that have their cells already keep them.
  void lay(std::span<const std::uint32_t> runs) {
    if (!m_rotation) return;
    std::vector<std::uint32_t> missing;
    for (const std::uint32_t r : runs)
      if (!m_laid[r] && !m_runs[r].view.onePixel) m_laid[r] = true, missing.push_back(r);
    auto& cells = m_cells.emplace_back(missing.size());
    parallelFor(missing.size(), 1, [&](std::size_t first, std::size_t last, int) {
      for (std::size_t i = first; i < last; ++i) fit(m_runs[missing[i]], cells[i]);
    });
  }

 private:
  void fit(SplatRun& run, CellNormals& cells) const {
    cells = cellNormals({run.points, run.count}, run.spacing, *m_rotation);
    run.view.cellNormals = &cells.normal[0].x;
    std::copy(cells.low.begin(), cells.low.end(), run.view.cellLow);
    run.view.cellShift = cells.shift;
  }

  std::span<SplatRun> m_runs;
  std::optional<glm::dmat3> m_rotation;
  std::vector<bool> m_laid;
  std::vector<std::vector<CellNormals>> m_cells;
};

/// The device's plane; null where there is none or it failed.
const void* drawOnDevice(SplatDevice* device, std::span<const SplatRun> runs, SurfaceFits& fits, const SplatLevels& levels,
                         SplatPayload payload) {
  if (!device) return nullptr;
  std::vector<const SplatRun*> unchecked;
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t r = 0; r < runs.size(); ++r)
    if (!runs[r].view.checkDomain) unchecked.push_back(&runs[r]), numbers.push_back(r);
  fits.lay(numbers);
  auto plane = device->draw(unchecked, levels, payload);
  if (plane) return *plane;
  logWarning("The processor draws the points: " + plane.error().text());
  return nullptr;
}

/// Where, in tasks from the nearest on, it pays to look what is hidden: after more and more of the points that are drawn wide.
/// Nowhere with few of them.
std::vector<std::size_t> looksOf(std::span<const SplatRun> runs, const std::vector<Task>& tasks) {
  std::uint64_t wide = 0, drawn = 0;
  for (const Task& task : tasks) wide += runs[task.run].view.onePixel ? 0 : task.count;
  std::vector<std::size_t> looks;
  if (wide < kFewToHide) return looks;
  std::uint64_t next = wide / kNearestShare;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (drawn >= next && drawn < wide) looks.push_back(i), next = kMoreBeforeNext * drawn;
    drawn += runs[tasks[i].run].view.onePixel ? 0 : tasks[i].count;
  }
  return looks;
}

/// As many as the widest of the points need, and one above that closes the holes of theirs.
int levelsFor(std::span<const SplatRun> runs) {
  double widest = 1.0;
  for (const SplatRun& run : runs)
    if (!run.view.onePixel) widest = std::max(widest, std::min<double>(run.view.largest, run.nearest > 0 ? run.view.sizeTimesDepth / run.nearest : run.view.largest));
  return std::min(SplatLevels::kMost, 2 + static_cast<int>(std::ceil(std::log2(widest))));
}

/// Draws one frame's runs into one plane a thread.
template <class Pixel>
class PlaneDrawer {
 public:
  PlaneDrawer(std::span<SplatRun> runs, int width, int height, const SplatDrawing& drawing)
      : m_runs(runs), m_payload(drawing.payload), m_closeHoles(drawing.closeHoles), m_levels(width, height, drawing.intoLevels ? levelsFor(runs) : 1),
        m_fits(runs, drawing.intoLevels ? nullptr : drawing.onSurface), m_planes(static_cast<std::size_t>(workerCount())) {
    if (drawing.intoLevels)
      for (SplatRun& run : runs) run.view.levels = &m_levels;
  }

  const SplatLevels& levels() const { return m_levels; }

  /// Clears the planes for the next frame, on all cores.
  void release() {
    parallelFor(m_planes.size(), 1, [&](std::size_t first, std::size_t last, int) {
      for (std::size_t i = first; i < last; ++i) m_planes[i].reset();
    });
  }
  std::optional<LevelSurface> coarse(const SplatPlanes<Pixel>& all) const {
    return coarseSurface(all, m_levels, m_closeHoles, 1, surfacePayloadOf(m_payload));
  }

  SplatPlanes<Pixel> draw(SplatDevice* device) {
    m_onDevice = static_cast<const Pixel*>(drawOnDevice(device, m_runs, m_fits, m_levels, m_payload));
    std::vector<Task> tasks = tasksOf(m_runs, m_onDevice != nullptr);
    shareOut(m_runs, tasks, m_planes.size());
    if (m_levels.count > 1) std::ranges::stable_sort(tasks, {}, [&](const Task& task) { return m_runs[task.run].nearest; });
    std::size_t first = 0;
    if (m_levels.count > 1) {
      for (const std::size_t look : looksOf(m_runs, tasks)) {
        drawTasks(std::span(tasks).subspan(first, look - first));
        if (!m_hidden) m_hidden.emplace(m_levels.columns[0], m_levels.rows[0]);
        // What level 0 has alone is not looked at.
        m_hidden->look(*coarseSurface(planes(), m_levels, m_closeHoles, 2, SurfacePayload::None));
        first = look;
      }
    }
    drawTasks(std::span(tasks).subspan(first));
    return planes();
  }

 private:
  SplatPlanes<Pixel> planes() const {
    SplatPlanes<Pixel> planes;
    if (m_onDevice) planes.planes.push_back({m_onDevice});
    for (const auto& plane : m_planes)
      if (plane) planes.planes.push_back({static_cast<const Pixel*>(plane->pixels()), plane->touched()});
    return planes;
  }

  void drawTasks(std::span<const Task> tasks) {
    std::vector<std::uint8_t> isHidden(tasks.size(), 0);
    if (m_hidden) {
      parallelFor(tasks.size(), 8, [&](std::size_t first, std::size_t last, int) {
        for (std::size_t i = first; i < last; ++i) isHidden[i] = m_hidden->hides(m_runs[tasks[i].run]);
      });
    }
    std::vector<std::vector<Task>> shares(m_planes.size());
    std::vector<std::uint32_t> runs;
    for (std::size_t i = 0; i < tasks.size(); ++i)
      if (isHidden[i] == 0) shares[tasks[i].share].push_back(tasks[i]), runs.push_back(tasks[i].run);
    for (std::vector<Task>& own : shares) std::ranges::stable_sort(own, {}, [&](const Task& task) { return regionOf(m_runs[task.run]); });
    m_fits.lay(runs);
    // Who is done with his share helps the next with his.
    std::vector<std::atomic<std::size_t>> next(shares.size());
    parallelFor(shares.size(), 1, [&](std::size_t first, std::size_t last, int) {
      for (std::size_t own = first; own < last; ++own) {
        for (std::size_t k = 0; k < shares.size(); ++k) {
          const std::size_t from = (own + k) % shares.size();
          for (std::size_t i = next[from]++; i < shares[from].size(); i = next[from]++) drawTask(shares[from][i], targetOf(own));
        }
      }
    });
  }

  SplatTarget targetOf(std::size_t own) {
    auto& plane = m_planes[own];
    if (!plane) plane = std::make_unique<SplatPlane>(m_levels.pixels(), sizeof(Pixel));
    SplatTarget target;
    target.payload = m_payload;
    target.touched = plane->touched();
    if constexpr (sizeof(Pixel) == 4) {
      target.depth = static_cast<Pixel*>(plane->pixels());
    } else {
      target.packed = static_cast<Pixel*>(plane->pixels());
    }
    return target;
  }

  void drawTask(const Task& task, SplatTarget target) const {
    const SplatRun& run = m_runs[task.run];
    target.payloadBase = run.payloadBase + (m_payload == SplatPayload::Index ? task.first : 0);
    splatKernel().draw(run.view, &run.points[task.first].x, task.count, target);
  }

  std::span<SplatRun> m_runs;
  SplatPayload m_payload;
  bool m_closeHoles;
  SplatLevels m_levels;
  SurfaceFits m_fits;
  std::vector<std::unique_ptr<SplatPlane>> m_planes;
  const Pixel* m_onDevice = nullptr;
  std::optional<HiddenTiles> m_hidden;
};

template <class Pixel>
void drawPlanes(std::span<SplatRun> runs, int width, int height, const SplatDrawing& drawing, SplatDevice* device,
                const MergeRows<Pixel>& merge) {
  PlaneDrawer<Pixel> drawer(runs, width, height, drawing);
  const SplatPlanes<Pixel> planes = drawer.draw(device);
  const std::optional<LevelSurface> coarse = drawer.coarse(planes);
  parallelFor(static_cast<std::size_t>(height), kRowsPerBand, [&](std::size_t first, std::size_t last, int) {
    merge(planes, drawer.levels(), coarse ? &*coarse : nullptr, static_cast<int>(first), static_cast<int>(last));
  });
  drawer.release();
}

bool inDomain(const void* camera, float x, float y) {
  return static_cast<const Camera*>(camera)->project({x, y, 1.0}).has_value();
}

/// A radius within which the lens holds in every direction: the domain is star-shaped, so a ring of
/// good points vouches for its inside.
double surelyInsideRadius(const Camera& camera) {
  const double fold = camera.foldBackRadius();
  if (!std::isfinite(fold)) return fold;
  constexpr int kDirections = 360;
  for (const double part : {0.99, 0.95, 0.9, 0.8, 0.6, 0.4, 0.2}) {
    bool whole = true;
    for (int i = 0; i < kDirections && whole; ++i) {
      const double angle = 2 * std::numbers::pi * i / kDirections;
      whole = camera.project({part * fold * std::cos(angle), part * fold * std::sin(angle), 1.0}).has_value();
    }
    // Between two directions the border may dip a little.
    if (whole) return 0.98 * part * fold;
  }
  return 0.0;
}

/// Largest distance from the axis on the image plane, infinite where the box reaches the eye's plane: the
/// radius is largest at a corner, once all are before the eye.
double radiusOf(const Bounds& bounds, const RigidTransform& cameraFromWorld) {
  double radius = 0.0;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 corner = cameraFromWorld * bounds.corner(i);
    if (!(corner.z > 0.0)) return std::numeric_limits<double>::infinity();
    radius = std::max(radius, glm::length(glm::dvec2(corner)) / corner.z);
  }
  return radius;
}

/// Depths along the axis that points of the box can have, before the eye and behind it.
std::pair<double, double> depthRange(const Bounds& bounds, const RigidTransform& cameraFromWorld) {
  const glm::dmat3 rotation = cameraFromWorld.rotationMatrix();
  const glm::dvec3 axis(rotation[0][2], rotation[1][2], rotation[2][2]);
  const double centre = glm::dot(axis, bounds.centre() - cameraFromWorld.centre());
  const double half = glm::dot(glm::abs(axis), 0.5 * bounds.size());
  return {centre - half, centre + half};
}

/// True where a point of the box may lie beyond `radius` on the image plane.
bool reachesBeyond(double radius, const Bounds& bounds, const RigidTransform& cameraFromWorld) {
  return !(radiusOf(bounds, cameraFromWorld) <= radius);
}

/// Pixels that a point moves for each part that 1/z is off and each unit of its radius on the image plane:
/// the focal length times the most that the lens stretches a radius, over the picture.
double pixelsPerRadius(const Camera& camera) {
  constexpr int kSteps = 16;
  constexpr double kPart = 1e-4;
  double most = 0.0;
  for (int row = 0; row <= kSteps; ++row) {
    for (int column = 0; column <= kSteps; ++column) {
      const auto ray = camera.unproject(
          {camera.width() * (column / double(kSteps)) - 0.5, camera.height() * (row / double(kSteps)) - 0.5});
      if (!ray || !(ray->z > 0.0)) continue;
      const glm::dvec2 at = glm::dvec2(*ray) / ray->z;
      const double radius = glm::length(at);
      if (radius < 1e-6) continue;
      const glm::dvec2 moved =
          camera.projectUnchecked({at * (1.0 - kPart), 1.0}) - camera.projectUnchecked({at, 1.0});
      most = std::max(most, glm::length(moved) / (kPart * radius));
    }
  }
  return 1.02 * most;  // between the samples
}

/// C's multiply-add where the node allows it. In depths [R - h, R + h] the relative error of 2/R - z/R² is at
/// most (h/R)², which moves a pixel along its radius.
void chooseReciprocal(SplatView& view, const Bounds& bounds, const RigidTransform& cameraFromWorld,
                      double allowedPx) {
  view.reciprocal = Reciprocal::Division;
  const auto [nearest, farthest] = depthRange(bounds, cameraFromWorld);
  if (!(nearest > 0.0)) return;
  const double middle = 0.5 * (nearest + farthest);
  const double error = std::pow((farthest - middle) / middle, 2);
  // What lies outside the picture may move as it likes, as long as it does not come in.
  const double radius = std::min<double>(radiusOf(bounds, cameraFromWorld), view.pictureRadius);
  if (!(view.pixelsPerRadius * radius * error <= allowedPx)) return;
  view.reciprocal = Reciprocal::MultiplyAdd;
  view.twoOverR = static_cast<float>(2.0 / middle);
  view.overRSquared = static_cast<float>(1.0 / (middle * middle));
}

}  // namespace

double nearestDepth(const Bounds& bounds, const RigidTransform& cameraFromWorld) {
  return std::max(0.0, depthRange(bounds, cameraFromWorld).first);
}

SplatView baseView(const Camera& camera, const SplatOptions& options) {
  const Intrinsics& in = camera.intrinsics();
  SplatView view{};
  view.lens = Lens<float>(in.distortion.cast<float>());
  view.fx = static_cast<float>(in.fx);
  view.fy = static_cast<float>(in.fy);
  view.cx = static_cast<float>(in.cx);
  view.cy = static_cast<float>(in.cy);
  // A hair inside: a float's rounding must not let a point from beyond the fold in.
  view.foldBackSquared = static_cast<float>(camera.foldBackRadius() * camera.foldBackRadius() * (1.0 - 1e-6));
  const double inside = surelyInsideRadius(camera);
  view.surelyInsideSquared = static_cast<float>(inside * inside);
  view.checkDomain = view.surelyInsideSquared < view.foldBackSquared;
  view.camera = &camera;
  view.inDomain = inDomain;
  view.width = camera.width();
  view.height = camera.height();
  view.round = options.round;
  view.smallest =
      static_cast<float>(std::max(1.0, options.fixedSize ? options.pointSize : options.minimumSizePx));
  view.largest =
      static_cast<float>(std::max<double>(view.smallest, options.fixedSize ? 1.0 : options.maximumSizePx));
  view.reciprocal = options.reciprocal;
  if (options.reciprocal == Reciprocal::MultiplyAdd) {
    view.pixelsPerRadius = static_cast<float>(pixelsPerRadius(camera));
    view.pictureRadius = static_cast<float>(camera.imageRadius());
  }
  return view;
}

SurfacePayload surfacePayloadOf(SplatPayload payload) {
  return payload == SplatPayload::None ? SurfacePayload::None : payload == SplatPayload::Colour ? SurfacePayload::Colour : SurfacePayload::Other;
}

bool usesLevels(const SplatOptions& options) {
  return options.surface && !options.round && !(options.minimumSizePx > 1.0) && !options.fixedSize && !(options.worldSizeM > 0) && options.maximumSizePx > 1.0 && options.pointSize >= 1.0;
}

SplatRun makeRun(const PointStore& store, const SelectedRange& range, const RigidTransform& cameraFromWorld,
                 const SplatView& base, const SplatOptions& options) {
  const CloudNode& node = store.nodes()[range.node];
  const glm::dmat3 rotation = cameraFromWorld.rotationMatrix();
  // Eye first, then rotate: the large coordinates cancel before anything is multiplied by them.
  const glm::dvec3 origin = rotation * (node.origin - cameraFromWorld.centre());
  SplatRun run;
  run.points = range.styled ? range.styled : store.points().data() + range.first;
  run.count = range.count;
  run.view = base;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      run.view.m[3 * row + column] = static_cast<float>(rotation[column][row] * node.step);
    }
    run.view.t[row] = static_cast<float>(origin[row]);
  }
  run.view.checkDomain =
      base.checkDomain && reachesBeyond(std::sqrt(base.surelyInsideSquared), node.bounds, cameraFromWorld);
  if (base.reciprocal == Reciprocal::MultiplyAdd)
    chooseReciprocal(run.view, node.bounds, cameraFromWorld, options.reciprocalErrorPx);
  const double focal = std::sqrt(std::abs(static_cast<double>(base.fx) * base.fy));
  const bool isAutomatic = !options.fixedSize && !(options.worldSizeM > 0);
  const bool intoLevels = usesLevels(options);
  const double width = isAutomatic ? (intoLevels ? kCellCover : kCover) * range.spacing : options.worldSizeM;
  const double sizeTimesDepth = options.fixedSize ? 0.0 : options.pointSize * width * focal;
  run.spacing = isAutomatic ? range.spacing / node.step : 0.0;
  run.view.sizeTimesDepth = static_cast<float>(sizeTimesDepth);
  run.view.sizeLess = isAutomatic && !intoLevels ? static_cast<float>(kCover - 1.0) : 0.0f;
  const double nearest = nearestDepth(node.bounds, cameraFromWorld);
  run.nearest = nearest;
  run.boxMiddle = rotation * (node.bounds.centre() - cameraFromWorld.centre());
  const glm::dvec3 half = 0.5 * node.bounds.size();
  run.boxHalf = glm::dmat3(rotation[0] * half.x, rotation[1] * half.y, rotation[2] * half.z);
  run.view.onePixel = base.largest <= 1.0f || (base.smallest <= 1.0f && sizeTimesDepth <= (1.0 + run.view.sizeLess) * nearest);
  return run;
}

void drawRuns(
    std::span<SplatRun> runs, int width, int height, const SplatDrawing& drawing,
    const MergeRows<std::uint32_t>& mergeDepth, const MergeRows<std::uint64_t>& mergePacked,
    SplatDevice* device) {
  if (drawing.payload == SplatPayload::None) {
    drawPlanes<std::uint32_t>(runs, width, height, drawing, device, mergeDepth);
  } else {
    drawPlanes<std::uint64_t>(runs, width, height, drawing, device, mergePacked);
  }
}

}  // namespace alidade
