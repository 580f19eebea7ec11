// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/clock_offset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "base/parallel.h"
#include "camera/rolling_shutter.h"

namespace alidade {

namespace {

constexpr std::size_t kFewestPairs = 6, kFewestTracks = 10;
constexpr double kDifferenceSecs = 5e-4;  // of the numeric derivative
constexpr double kFittingPx = 3.0;
constexpr double kWorstMedianPx = 5.0;
/// A place farther from the best than this is another minimum.
constexpr double kApartSecs = 0.04;
/// What the best must be better by, in standard errors of the difference between pairs.
constexpr double kSurelyBetter = 3.0;

constexpr int kColumns = 4, kRows = 3, kRegions = kColumns * kRows;

int regionOf(const glm::dvec2& pixel, const Camera& camera) {
  const int column = std::clamp(static_cast<int>(kColumns * (pixel.x + 0.5) / camera.width()), 0, kColumns - 1);
  const int row = std::clamp(static_cast<int>(kRows * (pixel.y + 0.5) / camera.height()), 0, kRows - 1);
  return row * kColumns + column;
}

/// A track with its rays on the undistorted image plane.
struct Ray {
  glm::dvec2 first, second;
  double firstLater = 0, secondLater = 0;  // row times, seconds after the middle row
  int region = 0;                          // of the picture, where it was first seen
};

struct Pair {
  double firstSecs, secondSecs;
  std::vector<Ray> rays;
};

/// From the place measured to the nearest one on the epipolar segment, on the image plane.
glm::dvec2 missOf(const RigidTransform& secondFromFirst, const Ray& ray, double nearestM) {
  const glm::dvec3 far = secondFromFirst.rotation * glm::dvec3(ray.first, 1.0);
  const glm::dvec3& shift = secondFromFirst.translation;
  if (far.z < 0.05) return glm::dvec2(1.0);
  const auto at = [&](double inverseDepth) {
    const glm::dvec3 p = far + inverseDepth * shift;
    return glm::dvec2(p) / p.z;
  };
  // Before the second camera, too.
  double most = 1.0 / nearestM;
  if (far.z + most * shift.z < 0.1 * far.z) most = -0.9 * far.z / shift.z;
  const glm::dvec2 a = at(0), b = at(most), along = b - a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0 ? std::clamp(glm::dot(ray.second - a, along) / length2, 0.0, 1.0) : 0.0;
  return ray.second - (a + t * along);
}

/// cameraFromWorld of b relative to a, about a's centre: see interpolateOnScrew.
RigidTransform between(const RigidTransform& a, const RigidTransform& b) {
  const glm::dquat rotation = glm::normalize(b.rotation * glm::conjugate(a.rotation));
  return {rotation, b * a.centre()};
}

class OffsetProblem {
 public:
  OffsetProblem(const std::vector<TrackedPair>& pairs, const Camera& camera, const PoseTrack& track,
                const ClockOffsetOptions& options)
      : m_track(track), m_options(options),
        m_focal(std::sqrt(std::abs(camera.intrinsics().fx * camera.intrinsics().fy))) {
    const RollingShutter rows{options.readoutSecs, {}};
    for (const TrackedPair& pair : pairs) {
      Pair made{pair.firstSecs, pair.secondSecs, {}};
      for (const auto& [first, second] : pair.tracks) {
        const auto a = camera.unproject(first), b = camera.unproject(second);
        if (!a || !b) continue;
        made.rays.push_back({glm::dvec2(*a), glm::dvec2(*b), rows.secsAtRow(first.y, camera.height()),
                             rows.secsAtRow(second.y, camera.height()), regionOf(first, camera)});
      }
      if (made.rays.size() >= kFewestTracks) m_pairs.push_back(std::move(made));
    }
  }

  const std::vector<Pair>& pairs() const { return m_pairs; }

  /// Misses in pixels of one pair; nothing where the trajectory does not cover it.
  bool misses(const Pair& pair, double offset, bool rows, std::vector<glm::dvec2>& into) const {
    into.clear();
    const double first = pair.firstSecs + offset, second = pair.secondSecs + offset;
    const auto a = m_track.at(first).cameraFromWorld, b = m_track.at(second).cameraFromWorld;
    if (!a || !b) return false;
    const RigidTransform whole = between(*a, *b);
    for (const Ray& ray : pair.rays) {
      RigidTransform relative = whole;
      if (rows && m_options.readoutSecs != 0) {
        const auto rowA = m_track.at(first + ray.firstLater).cameraFromWorld;
        const auto rowB = m_track.at(second + ray.secondLater).cameraFromWorld;
        if (!rowA || !rowB) return false;
        relative = between(*rowA, *rowB);
      }
      into.push_back(m_focal * missOf(relative, ray, m_options.nearestM));
    }
    return true;
  }

  double loss(const std::vector<glm::dvec2>& misses) const {
    double sum = 0;
    for (const glm::dvec2& m : misses) sum += std::log1p(glm::dot(m, m) / (m_options.scalePx * m_options.scalePx));
    return sum;
  }

  double weight(const glm::dvec2& m) const {
    return 1.0 / (1.0 + glm::dot(m, m) / (m_options.scalePx * m_options.scalePx));
  }

 private:
  const PoseTrack& m_track;
  const ClockOffsetOptions& m_options;
  double m_focal;
  std::vector<Pair> m_pairs;
};

/// The mean loss of each pair at each place of the search; NaN where the trajectory does not cover the pair.
struct Search {
  std::vector<double> offsets;
  std::vector<std::vector<double>> losses;  // by offset, then pair

  /// Over the pairs that both places cover: how much worse `b` is than `a`, in standard errors.
  double worseBy(std::size_t b, std::size_t a) const {
    double sum = 0, squares = 0;
    int count = 0;
    for (std::size_t p = 0; p < losses[a].size(); ++p) {
      const double d = losses[b][p] - losses[a][p];
      if (!std::isfinite(d)) continue;
      sum += d, squares += d * d, ++count;
    }
    if (count < 2) return 0;
    const double mean = sum / count, variance = std::max(0.0, squares / count - mean * mean) / (count - 1);
    return variance > 0 ? mean / std::sqrt(variance) : mean > 0 ? 1e9 : 0;
  }

  /// Mean over the covered pairs; infinite where fewer than half are.
  double mean(std::size_t at) const {
    double sum = 0;
    std::size_t count = 0;
    for (const double loss : losses[at])
      if (std::isfinite(loss)) sum += loss, ++count;
    return 2 * count >= losses[at].size() && count >= kFewestPairs ? sum / static_cast<double>(count)
                                                                   : std::numeric_limits<double>::infinity();
  }
};

Search searchOver(const OffsetProblem& problem, const ClockOffsetOptions& options, const Progress& progress) {
  Search search;
  const int steps = static_cast<int>(std::ceil(options.rangeSecs / options.stepSecs));
  for (int i = -steps; i <= steps; ++i) search.offsets.push_back(options.startSecs + i * options.stepSecs);
  search.losses.assign(search.offsets.size(), std::vector<double>(problem.pairs().size(), std::nan("")));
  parallelFor(search.offsets.size(), 4, [&](std::size_t first, std::size_t last, int) {
    std::vector<glm::dvec2> misses;
    for (std::size_t i = first; i < last && !progress.cancelled(); ++i)
      for (std::size_t p = 0; p < problem.pairs().size(); ++p)
        if (problem.misses(problem.pairs()[p], search.offsets[i], false, misses))
          search.losses[i][p] = problem.loss(misses) / static_cast<double>(misses.size());
  });
  return search;
}

/// A pair's shares of the gradient by region of the picture, and when it was seen.
struct Score {
  double middleSecs, lengthSecs;
  std::array<double, kRegions> ofRegion{};
  double gradient() const { return std::accumulate(ofRegion.begin(), ofRegion.end(), 0.0); }
};

/// Of the scores' sum where those of pairs near each other in time are alike (Newey and West 1987): pairs that overlap share
/// pictures and movement. The weights fall to none at `kMemory` lengths of a pair.
double varianceByTime(const std::vector<Score>& scores) {
  constexpr double kMemory = 3;
  double longest = 0;
  for (const Score& s : scores) longest = std::max(longest, s.lengthSecs);
  double sum = 0, weights = 0, alone = 0;
  for (const Score& a : scores) {
    alone += a.gradient() * a.gradient();
    for (const Score& b : scores) {
      const double weight = std::max(0.0, 1 - std::abs(a.middleSecs - b.middleSecs) / std::max(kMemory * longest, 1e-9));
      weights += weight;
      sum += weight * a.gradient() * b.gradient();
    }
  }
  // As the scores add up to nothing at the minimum, what is left of few is too small by a known part. Few tell little of how
  // alike they are, and that they were opposite is not believed.
  const double left = 1 - weights / (static_cast<double>(scores.size()) * static_cast<double>(scores.size()));
  return left > 0.1 ? std::max(sum / left, alone) : std::numeric_limits<double>::infinity();
}

/// Of the scores' sum where those of a region of the picture are alike as long as it is seen: an edge that tracks slide along.
double varianceByRegion(const std::vector<Score>& scores) {
  double sum = 0, both = 0;
  for (int r = 0; r < kRegions; ++r) {
    double ofRegion = 0;
    for (const Score& s : scores) {
      const double one = s.ofRegion[static_cast<std::size_t>(r)];
      ofRegion += one;
      both += one * one;
    }
    sum += ofRegion * ofRegion;
  }
  return std::max(0.0, static_cast<double>(kRegions) / (kRegions - 1) * sum - both);
}

/// One step of Gauss-Newton with what is needed to judge it.
struct Step {
  double change = 0, variance = 0, information = 0;
  double squares = 0;  // of the fitting tracks' misses
  int fitting = 0, tracks = 0, pairs = 0;
  std::vector<double> sizes;
};

Step stepAt(const OffsetProblem& problem, double offset) {
  Step step;
  double gradient = 0;
  std::vector<Score> scores;
  std::vector<glm::dvec2> here, before, after;
  for (const Pair& pair : problem.pairs()) {
    if (!problem.misses(pair, offset, true, here) || !problem.misses(pair, offset - kDifferenceSecs, true, before) ||
        !problem.misses(pair, offset + kDifferenceSecs, true, after))
      continue;
    Score score{0.5 * (pair.firstSecs + pair.secondSecs), std::abs(pair.secondSecs - pair.firstSecs)};
    for (std::size_t i = 0; i < here.size(); ++i) {
      const glm::dvec2 slope = (after[i] - before[i]) / (2 * kDifferenceSecs);
      const double weight = problem.weight(here[i]), size = glm::length(here[i]);
      score.ofRegion[static_cast<std::size_t>(pair.rays[i].region)] += weight * glm::dot(slope, here[i]);
      step.information += weight * glm::dot(slope, slope);
      step.sizes.push_back(size);
      if (size < kFittingPx) step.squares += size * size, ++step.fitting;
    }
    gradient += score.gradient();
    scores.push_back(score);
    step.tracks += static_cast<int>(here.size());
    ++step.pairs;
  }
  if (step.information > 0) {
    step.change = -gradient / step.information;
    step.variance = (varianceByTime(scores) + varianceByRegion(scores)) / (step.information * step.information);
  }
  return step;
}

ClockOffset notFound(ClockOffset answer, std::string reason) {
  answer.found = false;
  answer.reason = std::move(reason);
  return answer;
}

const char* const kStillAdvice = "the pictures look the same at every offset. Film the camera turning and stopping, or set the offset by hand";

}  // namespace

Result<void> ClockOffsetOptions::validate() const {
  const bool numbers = std::isfinite(startSecs) && std::isfinite(readoutSecs);
  if (!numbers || !(rangeSecs > 0 && rangeSecs <= 3600) || !(stepSecs > 0) || rangeSecs / stepSecs > 1e5 || !(nearestM > 0) ||
      !(scalePx > 0) || !(worstStdSecs > 0))
    return fail("The search for the clock offset has no sensible range", {}, "Give a range of up to an hour in at most 100 000 steps");
  return {};
}

std::string ClockOffset::report() const {
  if (!found) return "Clock offset not found: " + reason;
  return fmt::format("Clock offset {:+.4f} s ± {:.4f} s (pose clock minus picture clock), from {} tracks in {} pairs of pictures; "
                     "{:.0f} % fit, {:.2f} px rms",
                     offsetSecs, stdSecs, tracks, pairs, 100 * fitting, rmsPx);
}

Result<ClockOffset> estimateClockOffset(const std::vector<TrackedPair>& pairs, const Camera& camera, const PoseTrack& track,
                                        const ClockOffsetOptions& options, const Progress& progress) {
  if (auto valid = options.validate(); !valid) return fail(valid.error());
  const OffsetProblem problem(pairs, camera, track, options);
  ClockOffset answer;
  answer.pairs = static_cast<int>(problem.pairs().size());
  if (problem.pairs().size() < kFewestPairs)
    return notFound(answer, fmt::format("only {} pairs of pictures could be compared. Use a longer video with more to see in it",
                                        problem.pairs().size()));

  const Search search = searchOver(problem, options, progress.part(0, 0.8));
  if (progress.cancelled()) return fail(cancelledError());
  std::size_t best = 0;
  for (std::size_t i = 0; i < search.offsets.size(); ++i)
    if (search.mean(i) < search.mean(best)) best = i;
  if (!std::isfinite(search.mean(best)))
    return notFound(answer, "the trajectory covers too few of the pictures at any offset in the range. Set a start nearer to it");
  // Where every place explains the pictures as well as any other, the camera stood still or moved evenly.
  bool anyWorse = false;
  for (std::size_t i = 0; i < search.offsets.size(); ++i)
    if (std::isfinite(search.mean(i)) && search.worseBy(i, best) > kSurelyBetter) anyWorse = true;
  if (!anyWorse) return notFound(answer, fmt::format("the camera hardly moves, or moves evenly: {}", kStillAdvice));
  if (best == 0 || best + 1 == search.offsets.size() || !std::isfinite(search.mean(best - 1)) || !std::isfinite(search.mean(best + 1)))
    return notFound(answer, fmt::format("the best, {:+.2f} s, lies at the end of what was searched. Search around it", search.offsets[best]));

  double offset = search.offsets[best];
  Step step;
  bool settled = false;
  for (int i = 0; i < 30 && !settled; ++i) {
    step = stepAt(problem, offset);
    const double change = std::clamp(step.change, -options.stepSecs, options.stepSecs);
    settled = std::abs(change) < 1e-7;
    offset += change;
  }
  progress.report(1, "Clock offset");
  answer.offsetSecs = offset;
  answer.stdSecs = std::sqrt(step.variance);
  answer.pairs = step.pairs;
  answer.tracks = step.tracks;
  answer.fitting = step.tracks > 0 ? static_cast<double>(step.fitting) / step.tracks : 0;
  answer.rmsPx = step.fitting > 0 ? std::sqrt(step.squares / step.fitting) : 0;
  if (step.pairs < static_cast<int>(kFewestPairs))
    return notFound(answer, "the trajectory covers too few of the pictures. Set a start nearer to the offset");
  if (!(step.information > 0)) return notFound(answer, fmt::format("the camera stands still: {}", kStillAdvice));
  std::nth_element(step.sizes.begin(), step.sizes.begin() + static_cast<std::ptrdiff_t>(step.sizes.size() / 2), step.sizes.end());
  if (const double median = step.sizes[step.sizes.size() / 2]; median > kWorstMedianPx)
    return notFound(answer, fmt::format("the poses explain the pictures nowhere in the range ({:.1f} px at best). Check that "
                                        "trajectory, calibration and video belong together, and search a wider range", median));
  if (!settled || std::abs(offset - search.offsets[best]) > kApartSecs)
    return notFound(answer, "the search did not settle. Use more pictures");
  for (std::size_t i = 0; i < search.offsets.size(); ++i) {
    const bool isValley = i > 0 && i + 1 < search.offsets.size() && search.mean(i) <= search.mean(i - 1) && search.mean(i) <= search.mean(i + 1);
    if (!isValley || std::abs(search.offsets[i] - offset) < kApartSecs || search.worseBy(i, best) > kSurelyBetter) continue;
    return notFound(answer, fmt::format("{:+.3f} s and {:+.3f} s explain the pictures equally well: the movement repeats itself. "
                                        "Search a narrower range, or use more pictures", offset, search.offsets[i]));
  }
  if (!std::isfinite(answer.stdSecs))
    return notFound(answer, "the pictures span too short a time to tell how sure it is. Use a longer video");
  if (answer.stdSecs > options.worstStdSecs)
    return notFound(answer, fmt::format("it is uncertain by {:.0f} ms: the camera moves too little or too evenly. Film it turning and "
                                        "stopping, or set the offset by hand", 1000 * answer.stdSecs));
  answer.found = true;
  return answer;
}

}  // namespace alidade
