// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Resection and bundle adjustment. With ALIDADE_BUNDLE_MODEL=FOLDER the bundle's problem is also written as a COLMAP
// text model there, for `colmap bundle_adjuster` on the same numbers; see RESULTS.md.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <fmt/os.h>
#include <opencv2/calib3d.hpp>

#include "adjust/network.h"
#include "adjust/resection.h"

namespace alidade {
namespace {

Intrinsics benchLens() {
  return *Intrinsics::fromParameters(CameraModel::OpenCv4, 1920, 1080, {1150, 1148, 965, 532, -0.12, 0.03, 5e-4, -4e-4});
}

struct Picks {
  Camera camera{benchLens()};
  RigidTransform start;
  std::vector<ResectionObservation> all;
};

/// A thousand, from a start half a metre and a degree off.
Picks thousandPicks(const glm::dvec3& where) {
  Picks picks;
  const RigidTransform truth = RigidTransform::cameraLookingAt(where, where + glm::dvec3(20, 10, -1));
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  picks.all.resize(1000);
  for (ResectionObservation& pick : picks.all) {
    const glm::dvec2 pixel(40 + 1840 * unit(random), 40 + 1000 * unit(random));
    pick.world = truth.inverse() * ((8 + 32 * unit(random)) * *picks.camera.unproject(pixel));
    pick.pixel = pixel + 0.5 * glm::dvec2(normal(random), normal(random));
  }
  picks.start.rotation = glm::normalize(glm::dquat(1, 0.01, -0.008, 0.012) * truth.rotation);
  picks.start.translation = -(picks.start.rotation * (truth.centre() + glm::dvec3(0.3, -0.2, 0.25)));
  return picks;
}

void resect_1000(benchmark::State& state) {
  const Picks picks = thousandPicks({402000, 5655000, 113});
  for (auto _ : state) {
    const auto summary = resect(picks.camera, picks.start, picks.all);
    if (!summary || !summary->converged) state.SkipWithError("not converged");
    benchmark::DoNotOptimize(summary->covariance);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * picks.all.size()));
}

/// The peer: OpenCV's refinement alone, no covariance, no outliers, coordinates near zero.
void resect_1000_opencv(benchmark::State& state) {
  const Picks picks = thousandPicks({0, 0, 2});
  const std::vector<double> p = picks.camera.intrinsics().parameters(), distortion(p.begin() + 4, p.end());
  const cv::Mat matrix = (cv::Mat_<double>(3, 3) << p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1);
  std::vector<cv::Point3d> world;
  std::vector<cv::Point2d> pixels;
  for (const ResectionObservation& pick : picks.all) {
    world.emplace_back(pick.world.x, pick.world.y, pick.world.z);
    pixels.emplace_back(pick.pixel.x, pick.pixel.y);
  }
  const glm::dmat3 r = picks.start.rotationMatrix();
  const cv::Mat rotation = (cv::Mat_<double>(3, 3) << r[0][0], r[1][0], r[2][0], r[0][1], r[1][1], r[2][1], r[0][2], r[1][2], r[2][2]);
  const glm::dvec3& t = picks.start.translation;
  for (auto _ : state) {
    cv::Mat rvec, tvec = (cv::Mat_<double>(3, 1) << t.x, t.y, t.z);
    cv::Rodrigues(rotation, rvec);
    cv::solvePnPRefineLM(world, pixels, matrix, distortion, rvec, tvec);
    benchmark::DoNotOptimize(tvec.data);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * picks.all.size()));
}

/// A street: cameras every metre and a half, each point seen by the ten or so cameras around it.
Network streetBundle(int frames, int ties) {
  Network n;
  n.cameras.push_back({"camera", benchLens(), false, false, false});
  const Camera camera(benchLens());
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::normal_distribution<double> normal;
  const auto three = [&](double size) { return size * glm::dvec3(normal(random), normal(random), normal(random)); };
  std::vector<RigidTransform> truth;
  for (int f = 0; f < frames; ++f) {
    const glm::dvec3 eye(1.5 * f, 0.5 * normal(random), 2 + 0.1 * normal(random));
    truth.push_back(RigidTransform::cameraLookingAt(eye, eye + glm::dvec3(4 * unit(random), 20, 0.5 * unit(random))));
    NetworkPose pose;
    pose.name = fmt::format("{:04}.jpg", f);
    RigidTransform start = truth.back();
    const glm::dvec3 turn = three(0.002);
    start.rotation = glm::normalize(glm::dquat(1, turn.x, turn.y, turn.z) * start.rotation);
    start.translation = -(start.rotation * (eye + three(0.03)));
    // The datum: first and last as they are.
    if (f == 0 || f == frames - 1) start = truth.back(), pose.locked.fill(true);
    pose.bodyFromWorld = start;
    n.poses.push_back(pose);
    n.frames.push_back({pose.name, f, 0, -1, 0, 0});
  }
  while (static_cast<int>(n.points.size()) < ties) {
    const glm::dvec3 point(0.75 * frames * (1 + unit(random)), 20 + 8 * unit(random), 5 + 5 * unit(random));
    std::vector<PictureObservation> seen;
    for (int f = 0; f < frames; ++f) {
      if (std::abs(truth[f].centre().x - point.x) > 8) continue;
      const auto pixel = camera.project(truth[f] * point);
      if (!pixel || !camera.inPicture(*pixel)) continue;
      seen.push_back({f, static_cast<int>(n.points.size()), *pixel + 0.5 * glm::dvec2(normal(random), normal(random)), 1.0, false});
    }
    if (seen.size() < 3) continue;
    NetworkPoint tie;
    tie.world = point + three(0.05);
    n.points.push_back(tie);
    n.observations.insert(n.observations.end(), seen.begin(), seen.end());
  }
  return n;
}

/// COLMAP's pixel origin is the corner of the top-left pixel: half a pixel more.
void writeColmapModel(const Network& n, const std::string& folder) {
  std::filesystem::create_directories(folder);
  const Intrinsics in = n.cameras[0].intrinsics;
  auto cameras = fmt::output_file(folder + "/cameras.txt");
  cameras.print("1 OPENCV {} {}", in.width, in.height);
  std::vector<double> parameters = in.parameters();
  parameters[2] += 0.5, parameters[3] += 0.5;
  for (const double p : parameters) cameras.print(" {:.17g}", p);
  cameras.print("\n");
  auto images = fmt::output_file(folder + "/images.txt");
  std::vector<std::vector<std::pair<int, int>>> tracks(n.points.size());
  std::vector<std::vector<const PictureObservation*>> byFrame(n.frames.size());
  for (const PictureObservation& o : n.observations) byFrame[o.frame].push_back(&o);
  for (std::size_t f = 0; f < n.frames.size(); ++f) {
    const RigidTransform& pose = *n.poses[f].bodyFromWorld;
    images.print("{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} 1 {}\n", f + 1, pose.rotation.w, pose.rotation.x,
                 pose.rotation.y, pose.rotation.z, pose.translation.x, pose.translation.y, pose.translation.z, n.frames[f].name);
    int index = 0;
    for (const PictureObservation* o : byFrame[f]) {
      images.print("{:.17g} {:.17g} {} ", o->pixel.x + 0.5, o->pixel.y + 0.5, o->point + 1);
      tracks[o->point].emplace_back(static_cast<int>(f) + 1, index++);
    }
    images.print("\n");
  }
  auto points = fmt::output_file(folder + "/points3D.txt");
  for (std::size_t p = 0; p < n.points.size(); ++p) {
    const glm::dvec3& x = *n.points[p].world;
    points.print("{} {:.17g} {:.17g} {:.17g} 0 0 0 1", p + 1, x.x, x.y, x.z);
    for (const auto& [image, index] : tracks[p]) points.print(" {} {}", image, index);
    points.print("\n");
  }
}

void bundle(benchmark::State& state, const NetworkOptions& options, bool datum) {
  Network network = streetBundle(100, 20'000);
  if (const char* folder = std::getenv("ALIDADE_BUNDLE_MODEL")) writeColmapModel(network, folder);
  if (!datum)
    for (NetworkPose& pose : network.poses) pose.locked.fill(false);
  double cost = 0;
  int iterations = 0;
  for (auto _ : state) {
    const auto summary = adjustNetwork(network, options);
    if (!summary || !summary->converged) {
      state.SkipWithError(summary ? summary->reason.c_str() : summary.error().what.c_str());
      break;
    }
    cost = summary->finalCost, iterations = summary->iterations;
  }
  state.counters["final_cost"] = cost;
  state.counters["iterations"] = iterations;
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * network.observations.size()));
}

/// What COLMAP's bundle adjuster does: least squares without a loss, no covariance, no hunt for outliers, the datum free
/// but for seven parameters.
void bundle_100x20000(benchmark::State& state) {
  NetworkOptions options;
  options.huberSigmas = 0;
  options.covariance = false;
  options.freeNetwork = true;
  bundle(state, options, false);
}

/// The same with robust loss, outliers, standard deviations and ellipses of all poses.
void bundle_100x20000_with_accuracy(benchmark::State& state) {
  bundle(state, {}, true);
}

BENCHMARK(resect_1000_opencv)->Unit(benchmark::kMillisecond);
BENCHMARK(resect_1000)->Unit(benchmark::kMillisecond);
BENCHMARK(bundle_100x20000)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(bundle_100x20000_with_accuracy)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace alidade
