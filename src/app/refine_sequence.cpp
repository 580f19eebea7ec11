// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/refine_sequence.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "align/patch_matching.h"
#include "align/picture_levels.h"
#include "align/row_photo.h"
#include "app/pose_clock.h"
#include "base/parallel.h"

namespace alidade {

namespace {

/// What the poses of a camera that stands still may differ by.
constexpr double kStillM = 0.001, kStillRad = 1e-4;
/// An alarm needs so many pixels, and so many times what the pose is known to.
constexpr double kAlarmPx = 0.5, kAlarmFactor = 2;
constexpr int kTieWidth = 640;
constexpr int kTieHalf = 8, kTieRadius = 6;
constexpr double kTieCorrelation = 0.85, kTieSigmaPx = 0.2;
constexpr int kLeastTies = 12;
constexpr double kWeakestPx = 0.7;  // of a place that counts as a point
constexpr std::size_t kEdgesAPlace = 3;  // a place on an edge knows one direction only
constexpr double kEdgePiecePx = 5;

bool standsStill(const RigidTransform& a, const RigidTransform& b) {
  return glm::distance(a.centre(), b.centre()) < kStillM && rotationAngleBetween(a, b) < kStillRad;
}

/// What a place is good for: its standard deviations where it is known best and least, and in the picture the unit direction
/// in which it is known least, along an edge.
struct Certainty {
  double bestPx, leastPx;
  glm::dvec2 along;
};
Certainty certaintyOf(const SeenPlace& place) {
  const glm::dmat2& w = place.information;
  const double mean = 0.5 * (w[0][0] + w[1][1]), half = std::hypot(0.5 * (w[0][0] - w[1][1]), w[1][0]);
  const double angle = 0.5 * std::atan2(2 * w[1][0], w[0][0] - w[1][1]);
  return {1 / std::sqrt(std::max(1e-9, mean + half)), 1 / std::sqrt(std::max(1e-9, mean - half)), {-std::sin(angle), std::cos(angle)}};
}

class Sequence {
 public:
  Sequence(Project& project, const AlignmentScene& scene, PictureCache& pictures, const SequenceOptions& options,
           const Progress& progress)
      : m_project(project), m_scene(scene), m_pictures(pictures), m_options(options), m_progress(progress) {}

  Result<SequenceSummary> run() {
    if (auto valid = m_options.validate(); !valid) return fail(valid.error());
    if (auto chosen = choose(); !chosen) return fail(chosen.error());
    for (std::size_t i = 0; i < m_keys.size(); ++i) {
      m_progress.report(0.8 * static_cast<double>(i) / static_cast<double>(m_keys.size()), "Aligning the frames");
      if (m_progress.cancelled()) return fail(cancelledError());
      if (auto done = alignKey(i); !done) return fail(done.error());
    }
    for (std::size_t i = 1; i < m_keys.size(); ++i) {
      m_progress.report(0.8 + 0.1 * static_cast<double>(i) / static_cast<double>(m_keys.size()), "Following points");
      if (m_progress.cancelled()) return fail(cancelledError());
      tie(i - 1, i);
    }
    raiseAlarms();
    return adjust();
  }

 private:
  struct Key {
    FrameId id;
    CameraId camera;
    RigidTransform before, guess;
    std::vector<SeenPlace> places;
    AlignmentSummary alignment;
    bool aligned = false;
    std::string reason;
    bool still = false;
  };
  struct Tie {
    std::size_t first, second;
    glm::dvec2 firstPixel, secondPixel;
    glm::dvec3 world, normal;
    double scale;  ///< raw pixels a pixel that was matched
  };

  Result<void> choose() {
    int count = 0;
    for (const Frame& frame : m_project.frames) {
      if (!frame.cameraFromWorld) continue;
      if (count++ % m_options.everyNth != 0) continue;
      if (!m_project.findCamera(frame.camera)) return fail("Frame '" + frame.name + "' has no camera", m_project.path, "Add a calibration first");
      Key key;
      key.id = frame.id, key.camera = frame.camera, key.before = key.guess = *frame.cameraFromWorld;
      m_keys.push_back(std::move(key));
    }
    if (m_keys.size() < 2)
      return fail("A sequence needs two frames with poses", m_project.path, "Add poses: a trajectory or a camera file, or refine the frame by itself with --auto");
    for (Key& key : m_keys) {
      key.still = m_keys.size() >= 3 && std::all_of(m_keys.begin(), m_keys.end(), [&](const Key& other) {
        return other.camera != key.camera || standsStill(key.before, other.before);
      });
    }
    return {};
  }

  /// Where the frame should be by the motion since the last one that was found.
  RigidTransform predicted(std::size_t i) const {
    for (std::size_t back = i; back-- > 0;)
      if (m_keys[back].camera == m_keys[i].camera && m_keys[back].aligned)
        return m_keys[i].before * m_keys[back].before.inverse() * m_keys[back].guess;
    return m_keys[i].before;
  }

  Result<void> alignKey(std::size_t i) {
    Key& key = m_keys[i];
    const Frame& frame = *m_project.findFrame(key.id);
    const auto picture = m_pictures.picture(m_project, frame);
    if (!picture) return fail(picture.error());
    const Camera& camera = m_project.findCamera(key.camera)->camera;
    const RigidTransform start = predicted(i);
    key.guess = start;
    AlignmentOptions options = m_options.alignment;
    options.shutter = shutterOf(m_project, frame);
    for (const bool near : {true, false}) {
      options.startIsNear = near;
      if (near && i == 0) continue;
      auto summary = alignPicture(m_scene, **picture, camera, start, options, m_progress.part(1, 1));
      if (!summary) {
        if (isCancelled(summary.error())) return fail(summary.error());
        key.reason = summary.error().text();
        break;
      }
      key.reason = summary->converged ? std::string() : summary->reason;
      key.alignment = std::move(*summary);
      if (!key.alignment.converged) continue;
      key.aligned = true, key.guess = key.alignment.cameraFromWorld, key.places = key.alignment.places;
      break;
    }
    return {};
  }

  /// Natural points of one keyframe followed to the next, where the scan is their surface.
  void tie(std::size_t first, std::size_t second) {
    if (m_keys[first].camera != m_keys[second].camera || (!m_keys[first].aligned && !m_keys[second].aligned)) return;
    const auto from = levelOf(m_keys[first]), to = levelOf(m_keys[second]);
    if (!from || !to) return;
    const ScanView view = drawScanView(m_scene, from->camera, m_keys[first].guess);
    Image<std::uint8_t> known(view.depth.width(), view.depth.height());
    for (std::size_t i = 0; i < known.size(); ++i) known.data()[i] = view.depth.data()[i] > 0 ? 1 : 0;
    const int side = static_cast<int>(std::sqrt(static_cast<double>(from->luma.size()) / (2.5 * m_options.tiesAPair)));
    const std::vector<Patch> patches = choosePatches(from->luma, known, kTieHalf, std::max(2 * kTieHalf, side));
    std::vector<std::optional<Tie>> found(patches.size());
    parallelFor(patches.size(), 4, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t i = begin; i < end; ++i) {
        const glm::dvec2 at(patches[i].at);
        const auto surface = surfaceAt(view, from->camera, m_keys[first].guess, middlePixel(view, *from, at));
        if (!surface) continue;
        const auto expected = project(to->camera, to->shutter, m_keys[second].guess * surface->first);
        if (!expected) continue;
        const auto place = findPatch(patches[i], to->luma, kTieRadius, kTieCorrelation, glm::ivec2(glm::round(*expected - at)));
        if (!place || place->sigmaPx > kTieSigmaPx) continue;
        found[i] = Tie{first, second, from->scale * (at + 0.5) - 0.5, to->scale * (place->pixel + 0.5) - 0.5,
                       surface->first, surface->second, from->scale};
      }
    });
    for (const auto& tie : found)
      if (tie) m_ties.push_back(*tie);
  }

  std::optional<PictureLevel> levelOf(const Key& key) const {
    const auto picture = m_pictures.picture(m_project, *m_project.findFrame(key.id));
    if (!picture) return std::nullopt;
    const int width = std::min(kTieWidth, (*picture)->width());
    auto levels = picturePyramid(**picture, m_project.findCamera(key.camera)->camera, width, width);
    levels.back().shutter = shutterOf(m_project, *m_project.findFrame(key.id));
    return std::move(levels.back());
  }

  /// Where the middle row's pose sees what a rolling shutter's picture shows at a pixel, as far away as the view is there.
  static glm::dvec2 middlePixel(const ScanView& view, const PictureLevel& level, const glm::dvec2& pixel) {
    const float depth = view.depth.at(static_cast<int>(pixel.x), static_cast<int>(pixel.y));
    const auto seen = level.shutter.isOn() && depth > 0 ? photoPixel(level.camera, level.shutter, pixel, depth) : std::nullopt;
    return seen ? pixel - (*seen - pixel) : pixel;
  }

  /// Place and normal of the scan behind a pixel, where it is a smooth surface.
  static std::optional<std::pair<glm::dvec3, glm::dvec3>> surfaceAt(const ScanView& view, const Camera& camera,
                                                                    const RigidTransform& pose, const glm::dvec2& at) {
    constexpr int reach = 3;
    const glm::ivec2 centre(glm::round(at));
    if (centre.x < reach || centre.y < reach || centre.x + reach >= view.depth.width() || centre.y + reach >= view.depth.height())
      return std::nullopt;
    const auto point = [&](const glm::dvec2& pixel, int x, int y) -> std::optional<glm::dvec3> {
      const double depth = view.depth.at(x, y);
      const auto direction = camera.unproject(pixel);
      if (!(depth > 0) || !direction) return std::nullopt;
      return *direction * depth;
    };
    const auto middle = point(at, centre.x, centre.y);
    const auto left = point(centre - glm::ivec2(reach, 0), centre.x - reach, centre.y), right = point(centre + glm::ivec2(reach, 0), centre.x + reach, centre.y);
    const auto up = point(centre - glm::ivec2(0, reach), centre.x, centre.y - reach), down = point(centre + glm::ivec2(0, reach), centre.x, centre.y + reach);
    if (!middle || !left || !right || !up || !down) return std::nullopt;
    const double bend = std::max(std::abs(0.5 * (left->z + right->z) - middle->z), std::abs(0.5 * (up->z + down->z) - middle->z));
    if (bend > 0.01 * middle->z) return std::nullopt;
    const glm::dvec3 normal = glm::normalize(glm::cross(*right - *left, *down - *up));
    if (!std::isfinite(normal.x)) return std::nullopt;
    const RigidTransform back = pose.inverse();
    return std::pair(back * *middle, back.rotation * normal);
  }

  void raiseAlarms() {
    std::map<CameraId, const Key*> stood;
    for (const Key& key : m_keys) {
      if (!key.still || !key.aligned) continue;
      const auto [at, isFirst] = stood.emplace(key.camera, &key);
      if (isFirst) continue;
      const Key& then = *at->second;
      std::vector<glm::dvec3> world;
      for (const SeenPlace& place : key.places) world.push_back(place.world);
      const double pixels = distancePx(world, m_project.findCamera(key.camera)->camera, then.guess, key.guess);
      // Both poses' own 95 % of the mean pose; a scan's own faults are the same in both pictures.
      const double known = 1.731 * std::hypot(key.alignment.estimate.changePx * key.alignment.levelScale,
                                              then.alignment.estimate.changePx * then.alignment.levelScale);
      if (pixels < std::max(kAlarmPx, kAlarmFactor * known)) continue;
      m_alarms.push_back({key.id, glm::distance(then.guess.centre(), key.guess.centre()), rotationAngleBetween(then.guess, key.guess), pixels});
      at->second = &key;  // from now on it stands here
    }
  }

  /// Keyframes that were found, and those that enough points tie to one that was.
  std::vector<int> framesOf() const {
    std::vector<int> ties(m_keys.size(), 0), frames(m_keys.size(), -1);
    for (const Tie& tie : m_ties) ++ties[tie.first], ++ties[tie.second];
    int count = 0;
    for (std::size_t i = 0; i < m_keys.size(); ++i)
      if (m_keys[i].aligned || ties[i] >= kLeastTies) frames[i] = count++;
    return frames;
  }

  /// One pose a frame to begin with; `ids`: of the network's frames.
  Network networkOf(const std::vector<int>& frames, std::vector<FrameId>& ids) const {
    Network n;
    std::map<CameraId, int> cameras;
    for (std::size_t i = 0; i < m_keys.size(); ++i) {
      if (frames[i] < 0) continue;
      const Key& key = m_keys[i];
      const Frame& frame = *m_project.findFrame(key.id);
      const auto [camera, isNew] = cameras.emplace(key.camera, static_cast<int>(n.cameras.size()));
      if (isNew) {
        const CameraRecord& record = *m_project.findCamera(key.camera);
        n.cameras.push_back({record.name, record.camera.intrinsics()});
      }
      NetworkPose pose;
      pose.name = frame.name, pose.bodyFromWorld = key.guess, pose.timeSecs = frame.timeSecs;
      for (int k = 0; k < 3; ++k) pose.locked[k] = m_options.alignment.lockPosition[k], pose.locked[3 + k] = m_options.alignment.lockAttitude;
      n.poses.push_back(pose);
      NetworkFrame made;
      made.name = frame.name, made.pose = frames[i], made.camera = camera->second, made.shutter = shutterOf(m_project, frame);
      n.frames.push_back(made);
      ids.push_back(key.id);
      addPlaces(key, frames[i], n);
    }
    for (const Tie& tie : m_ties) {
      if (frames[tie.first] < 0 || frames[tie.second] < 0) continue;
      NetworkPoint point;
      point.name = fmt::format("tie {}", n.points.size() + 1);
      point.world = tie.world;
      point.surface = SurfaceHold{tie.world, tie.normal, std::max(0.003, m_scene.spacingM() / std::sqrt(12.0))};
      const int index = static_cast<int>(n.points.size());
      n.points.push_back(point);
      n.observations.push_back({frames[tie.first], index, tie.firstPixel, 0.1 * tie.scale, false});
      n.observations.push_back({frames[tie.second], index, tie.secondPixel, kTieSigmaPx * tie.scale, false});
    }
    return n;
  }

  /// Bodies that move do so smoothly: those that one camera carries, in time order.
  void smooth(const std::vector<int>& frames, Network& n) const {
    std::map<int, NetworkSmoothness> smoothness;
    for (std::size_t i = 0; i < m_keys.size(); ++i) {
      if (frames[i] < 0 || m_keys[i].still) continue;
      const NetworkFrame& frame = n.frames[frames[i]];
      NetworkSmoothness& s = smoothness[frame.mount < 0 ? frame.camera : n.frames.front().camera];
      if (s.poses.empty() || n.poses[s.poses.back()].timeSecs < n.poses[frame.pose].timeSecs) s.poses.push_back(frame.pose);
    }
    for (auto& [camera, s] : smoothness) {
      s.metresPerSecond2 = m_options.metresPerSecond2, s.radiansPerSecond2 = m_options.radiansPerSecond2;
      if (s.poses.size() >= 3) n.smoothness.push_back(s);
    }
  }

  /// Places of edges, each with a piece of its edge at its own depth.
  void addEdges(const Key& key, int frame, Network& n) const {
    const Camera& camera = m_project.findCamera(key.camera)->camera;
    const std::size_t step = std::max<std::size_t>(1, key.places.size() / (static_cast<std::size_t>(m_options.placesAFrame) * kEdgesAPlace));
    const int held = heldOutEvery();
    int taken = 0;
    for (std::size_t i = 0; i < key.places.size(); i += step) {
      const SeenPlace& place = key.places[i];
      const glm::dvec3 here = key.guess * place.world;
      const auto pixel = camera.project(here);
      const Certainty known = certaintyOf(place);
      const double sigma = key.alignment.estimate.sigma0 * known.bestPx;
      const auto beside = pixel ? camera.unproject(*pixel + kEdgePiecePx * key.alignment.levelScale * known.along) : std::nullopt;
      if (!beside) continue;
      const glm::dvec3 to = key.guess.inverse() * (*beside * here.z);
      ++taken;
      const bool isHeldOut = held > 0 && taken % held == 0;
      n.edges.push_back({frame, place.world, to, place.pixel, sigma, isHeldOut, fmt::format("{} edge {}", n.frames[frame].name, taken)});
    }
  }

  int heldOutEvery() const {
    return m_options.heldOutShare > 0 ? std::max(2, static_cast<int>(std::lround(1 / m_options.heldOutShare))) : 0;
  }

  void addPlaces(const Key& key, int frame, Network& n) const {
    if (!m_scene.hasColour()) return addEdges(key, frame, n);
    std::vector<const SeenPlace*> sure;
    for (const SeenPlace& place : key.places)
      if (certaintyOf(place).leastPx < kWeakestPx * key.alignment.levelScale) sure.push_back(&place);
    const std::size_t step = std::max<std::size_t>(1, sure.size() / static_cast<std::size_t>(m_options.placesAFrame));
    const int held = heldOutEvery();
    int taken = 0;
    for (std::size_t i = 0; i < sure.size(); i += step) {
      NetworkPoint point;
      point.name = fmt::format("{} place {}", n.frames[frame].name, ++taken);
      point.kind = PointKind::Scan, point.world = sure[i]->world;
      const double sigma = key.alignment.estimate.sigma0 * std::hypot(certaintyOf(*sure[i]).leastPx, 0.1 * key.alignment.levelScale);
      n.observations.push_back({frame, static_cast<int>(n.points.size()), sure[i]->pixel, sigma, held > 0 && taken % held == 0});
      n.points.push_back(std::move(point));
    }
  }

  Result<SequenceSummary> adjust() {
    SequenceSummary summary;
    summary.seenAs = framesOf();
    summary.alarms = m_alarms;
    int aligned = 0;
    for (const Key& key : m_keys) {
      SequenceFrame frame;
      frame.frame = key.id, frame.before = frame.after = key.before, frame.aligned = key.aligned, frame.reason = key.reason;
      frame.expectedPx = key.alignment.evidence.expectedPx;
      aligned += key.aligned ? 1 : 0;
      summary.frames.push_back(frame);
    }
    if (aligned == 0) {
      summary.reason = "no frame could be aligned: " + m_keys.front().reason;
      return summary;
    }
    std::vector<FrameId> ids;
    summary.network = networkOf(summary.seenAs, ids);
    auto clocks = tieMotion(m_project, ids, m_options.ties, summary.network);
    if (!clocks) return fail(clocks.error());
    summary.clocks = std::move(*clocks);
    smooth(summary.seenAs, summary.network);
    m_progress.report(0.92, "Adjusting");
    NetworkOptions options;
    for (std::size_t f = 0; f < summary.network.frames.size(); ++f)
      for (const glm::dvec3& point : m_options.at) options.at.push_back({static_cast<int>(f), point});
    auto adjusted = adjustNetwork(summary.network, options, m_progress.part(0.92, 1));
    if (!adjusted) return fail(adjusted.error());
    summary.adjustment = std::move(*adjusted);
    summary.converged = summary.adjustment.converged, summary.reason = summary.adjustment.reason;
    if (!summary.converged) return summary;
    for (std::size_t i = 0; i < m_keys.size(); ++i) {
      if (summary.seenAs[i] < 0) continue;
      summary.frames[i].refined = true;
      summary.frames[i].after = cameraFromWorld(summary.network, summary.adjustment, summary.seenAs[i]);
    }
    return summary;
  }

  const Project& m_project;
  const AlignmentScene& m_scene;
  PictureCache& m_pictures;
  const SequenceOptions& m_options;
  const Progress& m_progress;
  std::vector<Key> m_keys;
  std::vector<Tie> m_ties;
  std::vector<MovementAlarm> m_alarms;
};

/// Frames between two keyframes that were refined: their own motion, with the corrections of both blended in time.
void carryBetween(Project& project, const SequenceSummary& summary) {
  std::map<FrameId, const SequenceFrame*> keys;
  for (const SequenceFrame& frame : summary.frames)
    if (frame.refined) keys.emplace(frame.frame, &frame);
  // From the poses that the keyframes have now: another clock offset has moved them with the others.
  const auto corrected = [&](const SequenceFrame& key, const RigidTransform& pose) {
    return pose * project.findFrame(key.frame)->cameraFromWorld.value_or(key.before).inverse() * key.after;
  };
  for (std::size_t i = 0; i < project.frames.size(); ++i) {
    Frame& frame = project.frames[i];
    if (!frame.cameraFromWorld || keys.contains(frame.id)) continue;
    const Frame *before = nullptr, *after = nullptr;
    for (std::size_t k = i; k-- > 0 && !before;)
      if (project.frames[k].camera == frame.camera && keys.contains(project.frames[k].id)) before = &project.frames[k];
    for (std::size_t k = i + 1; k < project.frames.size() && !after; ++k)
      if (project.frames[k].camera == frame.camera && keys.contains(project.frames[k].id)) after = &project.frames[k];
    if (!before || !after || !(after->timeSecs > before->timeSecs)) continue;
    const double share = (frame.timeSecs - before->timeSecs) / (after->timeSecs - before->timeSecs);
    const RigidTransform one = corrected(*keys.at(before->id), *frame.cameraFromWorld), two = corrected(*keys.at(after->id), *frame.cameraFromWorld);
    RigidTransform pose;  // the two lie so near to each other that the way between them is straight
    pose.rotation = glm::slerp(one.rotation, two.rotation, share);
    pose.translation = -(pose.rotation * glm::mix(one.centre(), two.centre(), share));
    if (!frame.originalCameraFromWorld) frame.originalCameraFromWorld = frame.cameraFromWorld;
    frame.cameraFromWorld = pose;
    frame.poseSource = PoseSource::Interpolated;
  }
}

}  // namespace

Result<void> SequenceOptions::validate() const {
  if (everyNth < 1) return fail("Keyframes are every frame or fewer", "--keyframes", "Give 1 or more");
  if (placesAFrame < 10) return fail("A frame needs ten places of the scan at least");
  if (!(heldOutShare >= 0 && heldOutShare <= 0.5)) return fail("At most half of the places can be held out");
  return alignment.validate();
}

Result<SequenceSummary> refineSequence(Project& project, const AlignmentScene& scene, PictureCache& pictures,
                                       const SequenceOptions& options, bool dryRun, const Progress& progress) {
  auto summary = Sequence(project, scene, pictures, options, progress).run();
  if (!summary || !summary->converged || dryRun) return summary;
  std::vector<FrameId> seen;  // in the order of the network's frames
  for (std::size_t i = 0; i < summary->frames.size(); ++i)
    if (summary->seenAs[i] >= 0) seen.push_back(summary->frames[i].frame);
  applyMotion(project, seen, summary->network, summary->clocks, summary->adjustment);
  carryBetween(project, *summary);
  for (std::size_t i = 0; i < summary->frames.size(); ++i) {
    if (!summary->frames[i].refined) continue;
    Frame& frame = *project.findFrame(summary->frames[i].frame);
    const AdjustedPose& pose = summary->poseOf(i);
    if (!frame.originalCameraFromWorld) frame.originalCameraFromWorld = frame.cameraFromWorld;
    frame.cameraFromWorld = summary->frames[i].after;
    frame.poseSource = PoseSource::Refined;
    frame.quality = PoseQuality{pose.rmsPx, summary->adjustment.sigma0, pose.positionStdM, pose.rotationStdRad, pose.observations};
  }
  return summary;
}

std::vector<ExpectedError> SequenceSummary::expectedIn(std::size_t frame) const {
  const auto& all = adjustment.expected;
  const auto points = static_cast<std::ptrdiff_t>(all.size() / network.frames.size());
  const auto first = all.begin() + seenAs[frame] * points;
  return {first, first + points};
}

std::string SequenceSummary::report(const Project& project) const {
  std::string text = converged ? "Converged\n" : fmt::format("Not converged: {}\n", reason);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const SequenceFrame& f = frames[i];
    const Frame* frame = project.findFrame(f.frame);
    const std::string name = frame ? frame->name : "?";
    if (!f.refined) {
      text += fmt::format("{}: left as it was: {}\n", name, f.reason.empty() ? reason : f.reason);
      continue;
    }
    const AdjustedPose& pose = poseOf(i);
    text += fmt::format("{}: moved {:.3f} m, turned {:.3f}°, std {:.1f} {:.1f} {:.1f} mm{}\n", name,
                        glm::distance(f.before.centre(), f.after.centre()), rotationAngleBetween(f.before, f.after) * 57.29577951308232,
                        1000 * pose.positionStdM.x, 1000 * pose.positionStdM.y, 1000 * pose.positionStdM.z,
                        f.aligned ? "" : " (held by its neighbours)");
  }
  for (const MovementAlarm& alarm : alarms) {
    const Frame* frame = project.findFrame(alarm.frame);
    text += fmt::format("Movement: from {} on the camera stands {:.3f} m aside, turned {:.3f}° ({:.1f} px)\n", frame ? frame->name : "?",
                        alarm.metres, alarm.radians * 57.29577951308232, alarm.pixels);
  }
  if (!converged) return text;
  text += fmt::format("sigma naught {:.2f}, redundancy {}\n", adjustment.sigma0, adjustment.redundancy);
  for (std::size_t i = 0; i < adjustment.clockOffsetSecs.size(); ++i)
    text += fmt::format("clock offset {:.4f} s{}\n", adjustment.clockOffsetSecs[i],
                        network.trajectories[i].clockFree ? fmt::format(" ± {:.4f} s", adjustment.clockStdSecs[i]) : std::string(", locked"));
  text += mountsText(network, adjustment);
  for (const ResidualGroup& g : adjustment.groups)
    text += fmt::format("{}{}: {} observations, {} outliers, {:.2f} sigma{}\n", residualKindName(g.kind), g.heldOut ? " (held out)" : "",
                        g.count, g.outliers, g.rmsSigmas, std::isfinite(g.rmsPx) ? fmt::format(", {:.2f} px", g.rmsPx) : std::string());
  return text;
}

}  // namespace alidade
