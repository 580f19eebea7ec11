// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include <fmt/format.h>

#include "cli/command.h"
#include "cloud/level_report.h"
#include "cloud/store_folder.h"
#include "io/reader_registry.h"
#include "raster/splatter.h"

namespace alidade::cli {

namespace {

using Json = nlohmann::ordered_json;
using Points = std::shared_ptr<const PointStore>;

struct Arguments {
  std::string input;
  std::uint64_t points = 1'000'000;
};

/// About so many points of a scan's file or of a store, taken evenly.
Result<std::vector<PointBatch>> sampleOf(const Arguments& arguments, const Progress& progress) {
  std::vector<PointBatch> batches;
  const auto take = [&](PointBatch& batch) {
    batches.push_back(std::move(batch));
    return !progress.cancelled();
  };
  if (isStoreFolder(arguments.input)) {
    const auto store = openStore(arguments.input);
    if (!store) return fail(store.error());
    std::uint64_t all = 0;
    for (const StorePart& part : store->parts) all += part.points->pointCount();
    const std::uint64_t step = std::max<std::uint64_t>(1, all / arguments.points);
    for (const StorePart& part : store->parts)
      for (const CloudNode& node : part.points->nodes())
        if (node.count > 0) batches.push_back(part.points->batch(node.first, node.count).every(node.first % step < node.count ? node.first % step : 0, step));
    return batches;
  }
  const auto reader = ReaderRegistry::instance().find(arguments.input);
  if (!reader) return fail(reader.error());
  if ((*reader)->kind() != ReaderKind::Scan)
    return fail("This is no scan", arguments.input, "Name a scan's file or a point store");
  if (auto read = static_cast<const ScanReader&>(**reader).sample(arguments.input, arguments.points, take, progress); !read) return fail(read.error());
  return batches;
}

Result<Points> storeOf(const std::vector<PointBatch>& batches, LevelKind levels, const Progress& progress) {
  PointStoreBuilder::Options options;
  options.levels = levels;
  PointStoreBuilder builder(options);
  for (const PointBatch& batch : batches) builder.add(batch);
  return builder.build(progress);
}

/// How a picture of some points differs from that of all, over the latter's pixels.
struct PictureError {
  double grey = 0;   ///< root mean square, of 255; what is not drawn counts as black
  double depth = 0;  ///< share of the pixels without depth, or with one that is off by more than a hundredth
};

/// Both are drawn from a few standpoints: from above three sides, and from the middle.
class Pictures {
 public:
  explicit Pictures(const Points& all) : m_camera(*Intrinsics::fromParameters(CameraModel::Pinhole, 960, 540, {700, 700, 479.5, 269.5})) {
    const glm::dvec3 centre = all->bounds().centre();
    const double away = std::max(all->bounds().diagonal(), 1e-3);
    for (const glm::dvec3 from : {glm::dvec3(-0.5, -0.6, 0.5), glm::dvec3(0.7, 0.1, 0.4), glm::dvec3(-0.1, 0.6, 0.2)})
      m_views.push_back(RigidTransform::cameraLookingAt(centre + away * from, centre));
    m_views.push_back(RigidTransform::cameraLookingAt(centre, centre + away * glm::dvec3(1, 0.3, -0.1)));
    for (const RigidTransform& view : m_views) m_all.push_back(draw(all, 1.0, view));
  }

  PictureError errorOf(const Points& store, double share) const {
    double squares = 0, wrong = 0, pixels = 0;
    for (std::size_t v = 0; v < m_views.size(); ++v) {
      const SplatImages some = draw(store, share, m_views[v]);
      for (int y = 0; y < some.depth.height(); ++y) {
        for (int x = 0; x < some.depth.width(); ++x) {
          const double depth = m_all[v].depth.at(x, y);
          if (!std::isfinite(depth)) continue;
          const double apart = grey(m_all[v].colour.at(x, y)) - grey(some.colour.at(x, y));
          squares += apart * apart, pixels += 1;
          wrong += !(std::abs(some.depth.at(x, y) - depth) <= 0.01 * depth);
        }
      }
    }
    return pixels > 0 ? PictureError{std::sqrt(squares / pixels), wrong / pixels} : PictureError{};
  }

 private:
  SplatImages draw(const Points& store, double share, const RigidTransform& view) const {
    return splat({{store, selectShare(*store, share)}}, m_camera, view, {.colour = true});
  }
  static double grey(const Rgba8& c) { return c.a == 0 ? 0.0 : 0.299 * c.r + 0.587 * c.g + 0.114 * c.b; }

  const Camera m_camera;
  std::vector<RigidTransform> m_views;
  std::vector<SplatImages> m_all;
};

Result<Answer> compare(const Arguments& arguments, const Progress& progress) {
  const auto batches = sampleOf(arguments, progress.part(0.0, 0.2));
  if (!batches) return fail(batches.error());
  const auto blue = storeOf(*batches, LevelKind::BlueNoise, progress.part(0.2, 0.5));
  if (!blue) return fail(blue.error());
  const auto random = storeOf(*batches, LevelKind::Random, progress.part(0.5, 0.8));
  if (!random) return fail(random.error());
  if ((*blue)->pointCount() == 0) return fail("There are no points to compare", arguments.input, "Name a scan that has some");
  const Pictures pictures(*blue);
  Answer answer;
  answer.json = {{"input", arguments.input}, {"points", (*blue)->pointCount()}, {"levels", Json::array()}};
  answer.text = fmt::format("{}: {} points\n  lengths are shares of the hexagonal ideal\n"
                            "  share  levels      points  ideal m  spacing  hole area %  largest hole  grey rms  depth wrong %  spacing histogram %\n",
                            arguments.input, (*blue)->pointCount());
  for (const double share : {0.25, 0.0625, 0.015625}) {
    for (const auto& [name, store] : {std::pair{"blue-noise", *blue}, std::pair{"random", *random}}) {
      if (progress.cancelled()) return fail(cancelledError());
      const LevelSpread spread = spreadOfShare(*store, share);
      const PictureError error = pictures.errorOf(store, share);
      answer.json["levels"].push_back({{"share", share}, {"levels", name}, {"points", spread.points}, {"ideal_m", spread.idealM},
                                       {"mean_spacing", spread.meanSpacing}, {"spacing_shares", spread.spacings}, {"hole_area", spread.holeArea},
                                       {"largest_hole", spread.largestHole}, {"picture_rms", error.grey}, {"picture_depth_wrong", error.depth}});
      std::string histogram;
      for (const double part : spread.spacings) histogram += fmt::format(" {:.0f}", 100 * part);
      answer.text += fmt::format("  {:<6.3f} {:<10} {:>7}  {:>7.4f}  {:>7.3f}  {:>11.2f}  {:>12.2f}  {:>8.2f}  {:>13.2f} {}\n", share, name, spread.points,
                                 spread.idealM, spread.meanSpacing, 100 * spread.holeArea, spread.largestHole, error.grey, 100 * error.depth, histogram);
    }
  }
  return answer;
}

}  // namespace

void addLevels(Verbs& verbs) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = verbs.add("levels", "Compare blue-noise and random levels of a scan at equal point count",
                                [arguments](const Progress& progress) { return compare(*arguments, progress); });
  command->add_option("input", arguments->input, "A scan's file or a point store")->required();
  command->add_option("--points", arguments->points, "Look at so many of its points")->capture_default_str()->check(CLI::Range(1'000, 20'000'000));
}

}  // namespace alidade::cli
